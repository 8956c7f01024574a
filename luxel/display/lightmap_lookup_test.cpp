#include "luxel/display/lightmap_lookup.h"

#include <gtest/gtest.h>

namespace luxel::display {
namespace {

/// One triangle whose lightmap coordinates are its barycentric ones: (u, v).
scene::Scene triangle() {
  scene::Scene scene;
  scene::Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.uv1 = {{0, 0}, {1, 0}, {0, 1}};
  mesh.triangles = {{0, 1, 2}}, mesh.triangle_material = {0};
  scene.materials.emplace_back();
  scene.meshes.push_back(mesh);
  scene.instances.push_back({"triangle", 0, {}});
  return scene;
}

/// 4 x 2 texels: x in red, 10 y in green, 1 in blue.
image::Image ramp() {
  image::Image map(4, 2, 4);
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 4; ++x) map.set_rgb(x, y, {float(x), 10 * float(y), 1});
  return map;
}

TEST(LightmapAt, IsLinearBetweenTheMiddlesOfTexels) {
  // The middle of texel (x, y) is at ((x + 0.5) / 4, (y + 0.5) / 2).
  const scene::Scene scene = triangle();
  for (const auto& [u, v, want] : {std::tuple{0.125f, 0.25f, Rgb{0, 0, 1}},
                                   {0.375f, 0.25f, {1, 0, 1}},
                                   {0.25f, 0.25f, {0.5f, 0, 1}},
                                   {0.125f, 0.75f, {0, 10, 1}},
                                   {0.25f, 0.5f, {0.5f, 5, 1}},
                                   {0.3125f, 0.375f, {0.75f, 2.5f, 1}}})
    EXPECT_EQ(lightmap_at(scene, ramp(), {0, 0, {u, v}}), want) << u << ", " << v;
}

TEST(LightmapAt, EndsWithTheOuterTexels) {
  const scene::Scene scene = triangle();
  EXPECT_EQ(lightmap_at(scene, ramp(), {0, 0, {0, 0}}), (Rgb{0, 0, 1}));
  EXPECT_EQ(lightmap_at(scene, ramp(), {0, 0, {1, 0}}), (Rgb{3, 0, 1}));
  EXPECT_EQ(lightmap_at(scene, ramp(), {0, 0, {0, 1}}), (Rgb{0, 10, 1}));
}

TEST(LightmapAt, WithoutCoordinatesIsDark) {
  scene::Scene scene = triangle();
  scene.meshes[0].uv1.clear();
  EXPECT_EQ(lightmap_at(scene, ramp(), {0, 0, {0.25f, 0.25f}}), Rgb{});
}

}  // namespace
}  // namespace luxel::display
