#include "luxel/validate/random_scenes.h"

#include <cmath>

#include "luxel/base/random.h"
#include "luxel/scene/shapes.h"

namespace luxel::validate {
namespace {

struct SceneDice {
  uint64_t seed = 1, index = 0;

  float between(float low, float high) {
    return low + (high - low) * float(double(hash64(seed, index++) >> 11) * 0x1p-53);
  }
  /// Evenly in the logarithm.
  float decades(float low, float high) {
    return std::pow(10.0f, between(std::log10(low), std::log10(high)));
  }
  bool is_white = false;
  Rgb colour() {
    if (is_white) return {0.99f, 0.99f, 0.99f};
    return {between(0.1f, 0.85f), between(0.1f, 0.85f), between(0.1f, 0.85f)};
  }
};

/// Half the width and the depth, and the height of a room [m].
struct Room {
  float x = 1, y = 1, z = 1;
};

void add_walls(const Room& r, bool has_ceiling, SceneDice& dice, scene::Scene& s) {
  const uint32_t floor = scene::add_material(s, "floor", dice.colour());
  const uint32_t walls = scene::add_material(s, "walls", dice.colour());
  scene::Mesh mesh;
  mesh.name = "room";
  const float x = r.x, y = r.y, z = r.z;
  scene::add_quad(mesh, {Vec3{-x, 0, -z}, {-x, 0, z}, {x, 0, z}, {x, 0, -z}}, floor);
  if (has_ceiling)
    scene::add_quad(mesh, {Vec3{-x, y, -z}, {x, y, -z}, {x, y, z}, {-x, y, z}}, walls);
  scene::add_quad(mesh, {Vec3{-x, 0, -z}, {x, 0, -z}, {x, y, -z}, {-x, y, -z}}, walls);
  scene::add_quad(mesh, {Vec3{-x, 0, z}, {-x, 0, -z}, {-x, y, -z}, {-x, y, z}}, walls);
  scene::add_quad(mesh, {Vec3{x, 0, -z}, {x, 0, z}, {x, y, z}, {x, y, -z}}, walls);
  scene::add_quad(mesh, {Vec3{x, 0, z}, {-x, 0, z}, {-x, y, z}, {x, y, z}}, walls);
  scene::place(s, std::move(mesh));
}

/// A box of the given half sizes somewhere in the room, its bottom `gap` above the floor.
void add_thing(const Room& r, Vec3 half, float gap, SceneDice& dice, scene::Scene& s) {
  const uint32_t material = scene::add_material(s, "thing", dice.colour());
  const float x = dice.between(half.x - r.x, r.x - half.x) * 0.95f;
  const float z = dice.between(half.z - r.z, r.z - half.z) * 0.95f;
  scene::Mesh mesh;
  mesh.name = "thing";
  scene::add_box(mesh, {x - half.x, gap, z - half.z}, {x + half.x, gap + 2 * half.y, z + half.z},
                 material);
  scene::place(s, std::move(mesh));
}

/// A plate, a thin wall, a sliver or a box.
void add_random_thing(const Room& r, SceneDice& dice, scene::Scene& s) {
  const float size = std::min({r.x, r.y, r.z});
  const float thin = size * dice.decades(1e-4f, 1e-2f), gap = size * dice.decades(1e-4f, 1e-2f);
  const float a = size * dice.between(0.1f, 0.6f), b = size * dice.between(0.1f, 0.4f);
  const float kind = dice.between(0, 4);
  if (kind < 1) return add_thing(r, {a, thin, b}, gap, dice, s);
  if (kind < 2) return add_thing(r, {a, b, thin}, dice.between(0, 1) < 0.5f ? 0 : gap, dice, s);
  if (kind < 3) return add_thing(r, {thin, thin, a}, gap, dice, s);
  add_thing(r, {a, 0.5f * b, b}, 0, dice, s);
}

void add_square_lamp(const Room& r, float half, SceneDice& dice, scene::Scene& s) {
  const float y = r.y * dice.between(0.9f, 0.99f);
  const float x = dice.between(half - r.x, r.x - half) * 0.9f;
  const float z = dice.between(half - r.z, r.z - half) * 0.9f;
  const float radiance = r.x * r.z / (4 * half * half);
  const uint32_t glow = scene::add_material(s, "lamp", {}, {radiance, radiance, 0.9f * radiance});
  scene::add_rectangle(s, {x - half, x + half, z - half, z + half}, y, false, glow);
}

/// A ring in a level plane: twelve quads between two radii.
void add_ring(Vec3 middle, float inner, float outer, uint32_t material, scene::Mesh& mesh) {
  constexpr int kSides = 12;
  const auto at = [&](int k, float radius) {
    const float angle = 2 * kPi * float(k) / kSides;
    return middle + Vec3{radius * std::sin(angle), 0, radius * std::cos(angle)};
  };
  for (int k = 0; k < kSides; ++k)
    scene::add_quad(mesh, {at(k, inner), at(k, outer), at(k + 1, outer), at(k + 1, inner)},
                    material);
}

/// Slats across the room, each turned about its length, or rings about its middle. They cover a
/// third to two thirds of its plan.
void add_slats(const Room& r, SceneDice& dice, scene::Scene& s) {
  const uint32_t material = scene::add_material(s, "slats", dice.colour());
  s.materials[material].double_sided = true;
  const int count = 3 + int(dice.between(0, 4));
  const float y = r.y * dice.between(0.4f, 0.75f), part = dice.between(0.33f, 0.67f);
  const bool rings = dice.between(0, 1) < 0.4f;
  const float tilt = rings ? 0 : dice.between(-0.6f, 0.6f);
  scene::Mesh mesh;
  mesh.name = "slats";
  const float step = (rings ? 0.9f * std::min(r.x, r.z) : 1.9f * r.x) / float(count);
  for (int k = 0; k < count; ++k) {
    const float a = step * float(k), b = a + part * step;
    if (rings) {
      add_ring({0, y, 0}, a + 0.1f * step, b, material, mesh);
      continue;
    }
    const float x = 0.5f * (a + b) - 0.95f * r.x, half = 0.5f * part * step, z = 0.95f * r.z;
    const Vec3 across{half * std::cos(tilt), half * std::sin(tilt), 0}, middle{x, y, 0},
        along{0, 0, z};
    scene::add_quad(mesh,
                    {middle - across - along, middle - across + along, middle + across + along,
                     middle + across - along},
                    material);
  }
  scene::place(s, std::move(mesh));
}

/// Squares of n x n pixels, each a hole or not by chance.
scene::Texture holes(int n, float part, SceneDice& dice) {
  scene::Texture t;
  t.name = "holes";
  t.width = t.height = n;
  for (int k = 0; k < n * n; ++k) {
    const uint8_t alpha = dice.between(0, 1) < part ? 0 : 255;
    t.rgba.insert(t.rgba.end(), {230, 230, 230, alpha});
  }
  return t;
}

/// Two sheets with holes, one level and one upright, each an instance of its own.
void add_masks(const Room& r, SceneDice& dice, scene::Scene& s) {
  for (const bool level : {true, false}) {
    const uint32_t material = scene::add_material(s, "mask", dice.colour());
    s.textures.push_back(holes(4 + int(dice.between(0, 28)), dice.between(0.2f, 0.8f), dice));
    scene::Material& m = s.materials[material];
    m.base_color_texture = {.texture = uint32_t(s.textures.size() - 1),
                            .filter = scene::Filter::nearest};
    m.alpha_mode = scene::AlphaMode::mask, m.double_sided = true;
    const float x = 0.9f * r.x, z = 0.9f * r.z, at = dice.between(-0.8f, 0.8f);
    const float y = r.y * dice.between(0.3f, 0.8f), top = r.y * dice.between(0.5f, 0.95f);
    scene::Mesh sheet;
    sheet.name = "sheet";
    if (level)
      scene::add_quad(sheet, {Vec3{-x, y, -z}, {-x, y, z}, {x, y, z}, {x, y, -z}}, material);
    else
      scene::add_quad(
          sheet, {Vec3{at * r.x, 0, z}, {at * r.x, 0, -z}, {at * r.x, top, -z}, {at * r.x, top, z}},
          material);
    sheet.uv0 = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    scene::place(s, std::move(sheet));
  }
}

/// Gives every quad of the scene a cell of TEXCOORD_1, with borders anywhere in texels: charts lie
/// a hundredth of a cell apart, and most texels at their borders belong to two.
void share_texels(SceneDice& dice, scene::Scene& s) {
  size_t quads = 0;
  for (const scene::Mesh& m : s.meshes) quads += m.triangles.size() / 2;
  const auto side = size_t(std::ceil(std::sqrt(double(quads))));
  std::vector<float> borders;
  for (size_t k = 0; k <= side; ++k)
    borders.push_back((float(k) + (k == 0 || k == side ? 0 : dice.between(-0.2f, 0.2f))) /
                      float(side));
  size_t cell = 0;
  for (scene::Mesh& m : s.meshes) {
    const scene::Mesh before = std::move(m);
    m = {};
    m.name = before.name, m.triangle_material = before.triangle_material;
    for (size_t t = 0; t < before.triangles.size(); t += 2, ++cell) {
      const float u0 = borders[cell % side], v0 = borders[cell / side];
      const Vec2 size{borders[cell % side + 1] - u0, borders[cell / side + 1] - v0};
      const auto& a = before.triangles[t];
      const auto first = uint32_t(m.positions.size());
      for (const uint32_t v : {a[0], a[1], a[2], before.triangles[t + 1][2]})
        m.positions.push_back(before.positions[v]);
      for (const Vec2 at : {Vec2{0, 0}, {0, 1}, {1, 1}, {1, 0}})
        m.uv1.push_back(
            {u0 + size.x * (0.005f + 0.99f * at.x), v0 + size.y * (0.005f + 0.99f * at.y)});
      m.triangles.push_back({first, first + 1, first + 2});
      m.triangles.push_back({first, first + 2, first + 3});
    }
  }
}

/// A strip of ground along the room, with as few texels per metre as there may be.
void add_road(const Room& r, float size, SceneDice& dice, scene::Scene& s) {
  const uint32_t material = scene::add_material(s, "road", dice.colour());
  const float x = 1.01f * r.x, length_m = size * dice.decades(30, 400);
  const float z = length_m * dice.between(0.1f, 0.9f), width_m = size * dice.between(0.5f, 2);
  scene::add_rectangle(s, {x, x + width_m, -z, length_m - z}, 0, true, material);
  s.instances.back().texel_density = scene::kMinTexelDensity;
}

/// Walls from wall to wall, thinner than texels, at any angle; each second one leaves a gap above.
void add_barriers(const Room& r, SceneDice& dice, scene::Scene& s) {
  for (int k = 0; k < 2; ++k) {
    const uint32_t material = scene::add_material(s, "barrier", dice.colour());
    const float half = 0.5f * std::min(r.x, r.z) * dice.decades(1e-3f, 1e-2f);
    const float top = r.y * (k == 0 ? 1.01f : dice.between(0.3f, 0.9f));
    const float a = 0.9f * r.x * dice.between(-1, 1), b = 0.9f * r.x * dice.between(-1, 1);
    scene::Mesh wall;
    wall.name = "barrier";
    scene::add_box(wall, {-half, -0.01f * r.y, -1.01f * r.z}, {half, top, 1.01f * r.z}, material);
    for (Vec3& p : wall.positions) p.x += a + (b - a) * (0.5f + 0.5f * p.z / r.z);
    scene::place(s, std::move(wall));
  }
}

void move_away(float size, SceneDice& dice, scene::Scene& s) {
  const float far_m = 8 * size;
  const Vec3 by{dice.between(-far_m, far_m), dice.between(-far_m, far_m),
                dice.between(-far_m, far_m)};
  for (scene::Mesh& m : s.meshes)
    for (Vec3& p : m.positions) p += by;
  for (scene::PunctualLight& light : s.lights) light.position += by;
}

void add_lamp(int lamp, const Room& r, float size, SceneDice& dice, scene::Scene& s) {
  const float narrow = std::min(r.x, r.z);
  if (lamp == 0) add_square_lamp(r, 0.01f * narrow, dice, s);
  if (lamp == 1) add_square_lamp(r, 0.5f * narrow, dice, s);
  if (lamp == 2) {
    scene::PunctualLight point;
    point.position = {0.8f * dice.between(-r.x, r.x), r.y * dice.between(0.4f, 0.9f),
                      0.8f * dice.between(-r.z, r.z)};
    point.intensity = Rgb{1, 0.9f, 0.8f} * (size * size);
    s.lights.push_back(point);
  }
  if (lamp == 3) s.background = {1, 1, 1.2f};
}

}  // namespace

const char* name_of(Hard hard) {
  constexpr const char* kNames[] = {"nothing", "slats", "masks", "overlaps",
                                    "far",     "road",  "white", "barriers"};
  return kNames[size_t(hard)];
}

RandomScene random_scene(uint64_t seed, Hard hard) {
  SceneDice dice{hash64(seed, 0x5ce7e + uint64_t(hard)), 0, hard == Hard::white};
  const float size = dice.decades(1, 10);
  const Room r{size * dice.between(0.4f, 0.8f), size * dice.between(0.5f, 1.0f),
               size * dice.between(0.4f, 0.8f)};
  RandomScene out;
  const int any_lamp = int(dice.between(0, 4));
  const int lamp = hard == Hard::road ? 3 : hard == Hard::white ? any_lamp % 3 : any_lamp;
  add_walls(r, lamp != 3, dice, out.scene);
  const int things = 2 + int(dice.between(0, hard == Hard::nothing ? 5 : 2));
  for (int i = 0; i < things; ++i) add_random_thing(r, dice, out.scene);
  if (hard == Hard::slats) add_slats(r, dice, out.scene);
  if (hard == Hard::masks) add_masks(r, dice, out.scene);
  if (hard == Hard::road) add_road(r, size, dice, out.scene);
  if (hard == Hard::barriers) add_barriers(r, dice, out.scene);
  add_lamp(lamp, r, size, dice, out.scene);
  if (hard == Hard::overlaps) share_texels(dice, out.scene);
  if (hard == Hard::far) move_away(size, dice, out.scene);
  constexpr const char* kNames[] = {"tiny", "huge", "point", "sky"};
  out.lamp = kNames[lamp];
  return out;
}

}  // namespace luxel::validate
