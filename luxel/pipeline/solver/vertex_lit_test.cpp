#include "luxel/pipeline/solver/vertex_lit.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "luxel/scene/shapes.h"

namespace luxel::pipeline {
namespace {

/// A cube, mirrored and moved, whose light is a function of the place.
struct LitVertices {
  scene::Scene scene;
  hemicube::Field field;
};
LitVertices lit_cube(hemicube::ElementKind kind) {
  LitVertices out;
  scene::add_material(out.scene, "gray", {0.5f, 0.5f, 0.5f});
  out.scene.materials[0].emission = {2, 2, 2};
  scene::Mesh cube;
  scene::add_box(cube, {0, 0, 0}, {1, 1, 1}, 0);
  scene::place(out.scene, std::move(cube),
               from_columns({-2, 0, 0}, {0, 1, 0}, {0, 0, 3}, {10, 20, 30}));
  Progress progress;
  out.field.mesh = *hemicube::make_mesh(out.scene, {0.5f}, progress);
  out.field.receivers = hemicube::make_receivers(out.scene, out.field.mesh, kind);
  for (size_t i = 0; i < out.field.receivers.size(); ++i) {
    const Vec3 p = out.field.receivers.elements.position[i];
    out.field.irradiance.push_back({p.x + float(i), p.y, 7});
  }
  return out;
}

TEST(VertexLit, ColorsTimesIntensityAreTheLight) {
  const LitVertices lit = lit_cube(hemicube::ElementKind::vertex);
  const VertexLit out = vertex_lit(lit.scene, lit.field);
  ASSERT_EQ(out.scene.meshes.size(), 1u);
  const scene::Mesh& mesh = out.scene.meshes[0];
  EXPECT_EQ(mesh.triangles.size(), lit.field.mesh.triangle_count);
  EXPECT_EQ(mesh.positions.size(), lit.field.mesh.vertices.size());  // all shared
  for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const hemicube::Node& node = lit.field.mesh.nodes[lit.field.receivers.leaves[t]];
    // A triangle keeps its three corners, turned so that the front stays in front.
    EXPECT_GT(dot(scene::front_normal(out.scene, 0, t),
                  scene::front_normal(lit.scene, node.instance, node.triangle)),
              0.999f);
    for (const uint32_t v : mesh.triangles[t]) {
      const auto k = size_t(
          std::find_if(node.point.begin(), node.point.end(),
                       [&](uint32_t p) { return lit.field.mesh.points[p] == mesh.positions[v]; }) -
          node.point.begin());
      ASSERT_LT(k, 3u);
      const Rgb e = lit.field.irradiance[node.vertex[k]];
      const Rgb found = mesh.colors[v] * out.intensity;
      EXPECT_NEAR(found.x, e.x, 1e-5f * std::abs(e.x));
      EXPECT_NEAR(found.z, 7, 1e-5f);
    }
  }
  for (const scene::Material& m : out.scene.materials) {
    EXPECT_TRUE(m.unlit);
    EXPECT_EQ(m.emission, Rgb{}) << "unlit surfaces show none";
  }
}

TEST(VertexLit, LightPerTriangleSplitsAllVertices) {
  const LitVertices lit = lit_cube(hemicube::ElementKind::triangle);
  const VertexLit out = vertex_lit(lit.scene, lit.field);
  const scene::Mesh& mesh = out.scene.meshes[0];
  ASSERT_EQ(mesh.positions.size(), 3 * lit.field.mesh.triangle_count);
  for (uint32_t t = 0; t < mesh.triangles.size(); ++t)
    for (const uint32_t v : mesh.triangles[t])
      EXPECT_NEAR(mesh.colors[v].x * out.intensity, lit.field.irradiance[t].x, 1e-3f);
}

TEST(VertexLit, TheScenesOwnColorsMultiply) {
  LitVertices lit = lit_cube(hemicube::ElementKind::vertex);
  lit.scene.meshes[0].colors.assign(8, {0.5f, 0.25f, 1});
  const VertexLit out = vertex_lit(lit.scene, lit.field);
  for (const Rgb& c : out.scene.meshes[0].colors) EXPECT_NEAR(c.z * out.intensity, 7, 1e-5f);
  const LitVertices plain = lit_cube(hemicube::ElementKind::vertex);
  const VertexLit other = vertex_lit(plain.scene, plain.field);
  EXPECT_EQ(out.intensity, other.intensity);
}

// Darkness has a white level, too.
TEST(VertexLit, WithoutLightIsBlack) {
  LitVertices lit = lit_cube(hemicube::ElementKind::vertex);
  for (Rgb& e : lit.field.irradiance) e = {};
  const VertexLit out = vertex_lit(lit.scene, lit.field);
  EXPECT_EQ(out.intensity, 1);
  for (const Rgb& c : out.scene.meshes[0].colors) EXPECT_EQ(c, Rgb{});
}

}  // namespace
}  // namespace luxel::pipeline
