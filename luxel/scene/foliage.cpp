// Leaves over a floor: masks with holes, two sides, light scattered through.
#include "luxel/base/random.h"
#include "luxel/scene/place_camera.h"
#include "luxel/scene/procedural.h"
#include "luxel/scene/shapes.h"

namespace luxel::scene {
namespace {

constexpr int kLeafTexels = 64, kTwigs = 14, kLeavesPerTwig = 7;

/// A pointed leaf with a paler vein, its stalk at v = 1; the rest is a hole.
Texture leaf_texture() {
  Texture t;
  t.name = "leaf";
  t.width = t.height = kLeafTexels;
  for (int j = 0; j < kLeafTexels; ++j)
    for (int i = 0; i < kLeafTexels; ++i) {
      const float across = std::abs((float(i) + 0.5f) / kLeafTexels - 0.5f);
      const float along = (float(j) + 0.5f) / kLeafTexels;
      const float half_width = 1.7f * along * (1 - along) * (1.15f - 0.35f * along);
      const bool solid = across < half_width;
      const uint8_t shade = across < 0.02f ? 235 : 200;
      t.rgba.insert(t.rgba.end(), {shade, shade, uint8_t(shade - 30), uint8_t(solid ? 255 : 0)});
    }
  return t;
}

/// Leaves around a stalk along +y, each a flat card of 0.22 x 0.34 m.
Mesh twig(uint32_t leaf) {
  Mesh mesh;
  mesh.name = "twig";
  for (int k = 0; k < kLeavesPerTwig; ++k) {
    RandomStream random{hash64(11, uint64_t(k))};
    const float turn = 2.4f * float(k) + 0.3f * random.next(), rise = 0.25f + 0.5f * random.next();
    const Vec3 out{std::cos(turn), rise, std::sin(turn)};
    const Vec3 along = normalize(out) * 0.34f;
    const Vec3 across = normalize(cross(along, Vec3{0, 1, 0.2f * random.next()})) * 0.11f;
    const Vec3 stalk{0, 0.07f * float(k), 0};
    add_quad(mesh, {stalk - across, stalk + across, stalk + across + along, stalk - across + along},
             leaf);
    for (const Vec2 uv : {Vec2{0, 1}, {1, 1}, {1, 0}, {0, 0}}) mesh.uv0.push_back(uv);
  }
  return mesh;
}

}  // namespace

Scene foliage() {
  Scene scene;
  scene.name = "foliage";
  scene.background = {0.35f, 0.42f, 0.55f};
  // Materials: leaves are cut out of a texture and let light through.
  const uint32_t ground = add_material(scene, "ground", {0.5f, 0.45f, 0.38f});
  const uint32_t leaf = add_material(scene, "leaf", {0.2f, 0.42f, 0.1f});
  scene.textures.push_back(leaf_texture());
  Material& m = scene.materials[leaf];
  m.base_color_texture = {.texture = 0, .wrap_u = Wrap::clamp, .wrap_v = Wrap::clamp};
  m.alpha_mode = AlphaMode::mask;
  m.double_sided = true;
  m.diffuse_transmission = 0.4f;
  m.diffuse_transmission_color = {0.45f, 0.7f, 0.15f};
  // A floor, and one twig many times above it, turned and moved at random.
  add_rectangle(scene, {-1.5f, 1.5f, -1.5f, 1.5f}, 0, true, ground);
  scene.meshes.back().name = scene.instances.back().name = "floor";
  scene.meshes.push_back(twig(leaf));
  for (int k = 0; k < kTwigs; ++k) {
    RandomStream random{hash64(23, uint64_t(k))};
    const Vec3 at{2 * random.next() - 1, 0.5f + 0.6f * random.next(), 2 * random.next() - 1};
    const float turn = 6.28f * random.next(), c = std::cos(turn), s = std::sin(turn);
    scene.instances.push_back(
        {"twig " + std::to_string(k), 1, from_columns({c, 0, -s}, {0, 1, 0}, {s, 0, c}, at)});
  }
  // Light and camera.
  PunctualLight sun;
  sun.name = "sun";
  sun.kind = PunctualLight::Kind::directional;
  sun.direction = normalize(Vec3{-0.37f, -1, -0.21f});
  sun.intensity = {9, 8.2f, 7};
  scene.lights.push_back(sun);
  place_camera(scene, "front", {0.9f, 1.1f, 3.6f}, {0, 0.55f, 0}, 0.75f);
  return scene;
}

}  // namespace luxel::scene
