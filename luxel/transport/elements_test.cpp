#include "luxel/transport/elements.h"

#include <gtest/gtest.h>

#include "luxel/base/team_test_support.h"
#include "luxel/scene/procedural.h"

namespace luxel::transport {
namespace {

/// One texel whose sample is the given point of triangle 0.
Elements element_of(const scene::Scene& scene, Barycentric at) {
  atlas::Atlas atlas;
  atlas.resolution = 1;
  atlas.first_triangle = {0, 1};
  atlas.corners = {{Vec2{0, 0}, Vec2{1, 0}, Vec2{0, 1}}};
  atlas::TexelMap map;
  map.resolution = 1;
  map.texels.push_back({0, 0, {0, 0, at}, 0, true});
  map.texel_at = {0};
  return elements_from_texels(scene, atlas, map);
}

scene::Scene triangle_scene(std::array<Vec3, 3> corners, std::vector<Vec3> normals) {
  scene::Scene scene;
  scene.materials.push_back({});
  scene::Mesh mesh;
  mesh.positions.assign(corners.begin(), corners.end());
  mesh.normals = std::move(normals);
  mesh.triangles = {{0, 1, 2}};
  mesh.triangle_material = {0};
  scene.meshes.push_back(mesh);
  scene.instances.push_back({});
  return scene;
}

// A facet of the unit sphere with its exact normals: the lifted centre comes close to the sphere.
// The tangent planes of three corners at angle a from the centre meet the centre's ray at height
// 1/cos a, the facet at cos a; the projections rise by sin^2 a, so the radius becomes about
// cos a + cos a sin^2 a = 1 + a^2/2 - ...: off by half of the facet's sagitta, to the outside.
TEST(Elements, LieOnTheBulgeOfASmoothSurface) {
  const float a = 0.2f, s = std::sin(a), c = std::cos(a), h = std::sqrt(3.0f) / 2;
  const std::array<Vec3, 3> corners{{{s, 0, c}, {-0.5f * s, h * s, c}, {-0.5f * s, -h * s, c}}};
  const auto scene = triangle_scene(corners, {corners[0], corners[1], corners[2]});
  const Elements e = element_of(scene, {1.0f / 3, 1.0f / 3});
  EXPECT_NEAR(e.position[0].z, c + c * s * s, 1e-5f);
  EXPECT_NEAR(e.position[0].x, 0, 1e-6f);
  EXPECT_EQ(e.geometric_normal[0], e.normal[0]);
  // A corner is on the surface already.
  EXPECT_NEAR(length(element_of(scene, {1, 0}).position[0] - corners[1]), 0, 1e-6f);
}

TEST(Elements, StayOnFlatAndOnHollowTriangles) {
  const std::array<Vec3, 3> corners{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}};
  const Vec3 up{0, 0, 1};
  for (const auto& normals :
       {std::vector<Vec3>{}, std::vector<Vec3>{up, up, up},
        std::vector<Vec3>{normalize(Vec3{0.2f, 0.2f, 1}), normalize(Vec3{-0.2f, 0, 1}),
                          normalize(Vec3{0, -0.2f, 1})}}) {
    const Elements e = element_of(triangle_scene(corners, normals), {0.25f, 0.25f});
    EXPECT_NEAR(length(e.position[0] - Vec3{0.25f, 0.25f, 0}), 0, 1e-6f);
    EXPECT_EQ(e.geometric_normal[0], up);
  }
}

/// Eight stripes, black and white in turn.
scene::Scene striped_triangle() {
  auto scene = triangle_scene({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}, {});
  scene.meshes[0].uv0 = {{0, 0}, {1, 0}, {0, 1}};
  scene::Texture stripes;
  stripes.width = 8, stripes.height = 1;
  for (int i = 0; i < 8; ++i) {
    const uint8_t v = i % 2 ? 200 : 0;
    stripes.rgba.insert(stripes.rgba.end(), {v, v, v, 255});
  }
  scene.textures.push_back(stripes);
  scene.materials[0].base_color_texture.texture = 0;
  scene.materials[0].base_color_texture.filter = scene::Filter::nearest;
  return scene;
}

// Half of the texel is white, half black: its reflectance is the mean, not that of the sample.
TEST(Elements, ReflectanceIsTheMeanOverTheTexel) {
  const scene::Scene scene = striped_triangle();
  const float white = scene::reflectance_at(scene, {0, 0, {3 / 16.0f, 0.1f}}).x;
  ASSERT_GT(white, 0.5f);
  // 4 x 4 points see 4 of the 8 stripes at each end of a cell; nine or ten of them and the sample
  // lie in the triangle: within a tenth of one half.
  EXPECT_NEAR(element_of(scene, {0.3f, 0.3f}).reflectance[0].x / white, 0.5f, 0.5f);
  EXPECT_GT(element_of(scene, {0.3f, 0.3f}).reflectance[0].x, 0.0f);
}

// Several ranges of texels for three members, of a surface that also lets light through.
TEST(Elements, AreSharedOutByATeam) {
  scene::Scene scene = striped_triangle();
  scene.materials[0].diffuse_transmission = 0.25f;
  atlas::Atlas atlas;
  atlas.resolution = 200;
  atlas.first_triangle = {0, 1};
  atlas.corners = {{Vec2{0, 0}, Vec2{200, 0}, Vec2{0, 200}}};
  const atlas::TexelMap map = atlas::rasterise(scene, atlas);
  const Elements expected = elements_from_texels(scene, atlas, map);
  ASSERT_FALSE(expected.transmittance.empty());
  as_team(3, [&](Team& team) {
    Progress progress;
    const auto found = elements_together(scene, atlas, map, &team, progress);
    ASSERT_TRUE(found) << found.error().message;
    EXPECT_EQ(found->reflectance, expected.reflectance);
    EXPECT_EQ(found->transmittance, expected.transmittance);
    EXPECT_EQ(found->position, expected.position);
  });
}

}  // namespace
}  // namespace luxel::transport
