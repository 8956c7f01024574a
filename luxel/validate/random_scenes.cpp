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
  Rgb colour() { return {between(0.1f, 0.85f), between(0.1f, 0.85f), between(0.1f, 0.85f)}; }
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

}  // namespace

RandomScene random_scene(uint64_t seed) {
  SceneDice dice{hash64(seed, 0x5ce7e), 0};
  const float size = dice.decades(1, 10);
  const Room r{size * dice.between(0.4f, 0.8f), size * dice.between(0.5f, 1.0f),
               size * dice.between(0.4f, 0.8f)};
  RandomScene out;
  const int lamp = int(dice.between(0, 4));
  add_walls(r, lamp != 3, dice, out.scene);
  const int things = 2 + int(dice.between(0, 5));
  for (int i = 0; i < things; ++i) add_random_thing(r, dice, out.scene);
  const float narrow = std::min(r.x, r.z);
  if (lamp == 0) add_square_lamp(r, 0.01f * narrow, dice, out.scene);
  if (lamp == 1) add_square_lamp(r, 0.5f * narrow, dice, out.scene);
  if (lamp == 2) {
    scene::PunctualLight point;
    point.position = {0.8f * dice.between(-r.x, r.x), r.y * dice.between(0.4f, 0.9f),
                      0.8f * dice.between(-r.z, r.z)};
    point.intensity = Rgb{1, 0.9f, 0.8f} * (size * size);
    out.scene.lights.push_back(point);
  }
  if (lamp == 3) out.scene.background = {1, 1, 1.2f};
  constexpr const char* kNames[] = {"tiny", "huge", "point", "sky"};
  out.lamp = kNames[lamp];
  return out;
}

}  // namespace luxel::validate
