#include "luxel/scene/normal_map.h"

#include <gtest/gtest.h>

#include "luxel/scene/shapes.h"

namespace luxel::scene {
namespace {

/// A square in the plane y = 0, front up, u along +x and v along +z, in one colour of normal map.
Scene mapped_square(std::array<uint8_t, 3> color) {
  Scene scene;
  const uint32_t material = add_material(scene, "mapped", {0.5f, 0.5f, 0.5f});
  Mesh mesh;
  add_quad(mesh, {Vec3{0, 0, 1}, {1, 0, 1}, {1, 0, 0}, {0, 0, 0}}, material);
  mesh.uv0 = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
  place(scene, std::move(mesh));
  Texture t;
  t.width = t.height = 1;
  t.rgba = {color[0], color[1], color[2], 255};
  scene.textures.push_back(std::move(t));
  scene.materials[material].normal_texture.texture = 0;
  return scene;
}

Vec3 bent(const Scene& scene) { return bent_normal(scene, {0, 0, {0.25f, 0.25f}}); }

// 204 is 0.6 and 230 is 0.804 of [-1, 1]: a vector of length 1.003.
const std::array<uint8_t, 3> kAlongU{204, 128, 230}, kAgainstV{128, 204, 230};
// A byte is as exact as 1/255 of [-1, 1].
constexpr float kByte = 0.01f;

void expect_near(Vec3 a, Vec3 b, float tolerance) {
  EXPECT_LT(length(a - b), tolerance) << a.x << " " << a.y << " " << a.z;
}

TEST(NormalMap, RedBendsAlongUAndGreenAgainstV) {
  expect_near(bent(mapped_square(kAlongU)), {0.6f, 0.8f, 0}, kByte);
  expect_near(bent(mapped_square(kAgainstV)), {0, 0.8f, -0.6f}, kByte);
  expect_near(bent(mapped_square({128, 128, 255})), {0, 1, 0}, kByte);
}

TEST(NormalMap, FollowsMirroredAndTurnedCoordinates) {
  Scene mirrored = mapped_square(kAlongU);
  for (Vec2& uv : mirrored.meshes[0].uv0) uv.x = -uv.x;
  expect_near(bent(mirrored), {-0.6f, 0.8f, 0}, kByte);
  mirrored.materials[0].normal_texture.scale = {-2, 1};
  expect_near(bent(mirrored), {0.6f, 0.8f, 0}, kByte);
  // A quarter turn counter-clockwise in glTF's sense: u' = v, v' = -u.
  Scene turned = mapped_square(kAlongU);
  turned.materials[0].normal_texture.rotation = 0.5f * kPi;
  expect_near(bent(turned), {0, 0.8f, 0.6f}, kByte);
}

TEST(NormalMap, IsScaledAndTurnsWithItsInstance) {
  Scene scene = mapped_square(kAlongU);
  scene.materials[0].normal_scale = 0.5f;
  expect_near(bent(scene), normalize(Vec3{0.3f, 0.8f, 0}), kByte);
  scene.materials[0].normal_scale = 1;
  // x to y, y to -x.
  scene.instances[0].world_from_object = {{{{0, -1, 0, 5}, {1, 0, 0, 0}, {0, 0, 1, 0}}}};
  expect_near(bent(scene), {-0.8f, 0.6f, 0}, kByte);
}

TEST(NormalMap, WithoutCoordinatesIsTheShadingNormal) {
  Scene scene = mapped_square(kAlongU);
  scene.meshes[0].uv0.assign(4, {0.5f, 0.5f});
  expect_near(bent(scene), {0, 1, 0}, 1e-6f);
  scene.meshes[0].uv0.clear();
  expect_near(bent(scene), {0, 1, 0}, 1e-6f);
}

}  // namespace
}  // namespace luxel::scene
