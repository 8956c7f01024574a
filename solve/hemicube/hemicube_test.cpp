#include "solve/hemicube/hemicube.h"

#include <gtest/gtest.h>

#include "solve/hemicube/hemicube_test_support.h"

namespace luxel::hemicube {
namespace {

using testing::mesh_of;
using testing::scene_of;
using testing::solved;
using testing::try_to_solve;
using testing::unit_square;

HemicubeParams small(ElementKind kind) {
  HemicubeParams params;
  params.elements = kind, params.resolution = 16, params.element_size_m = 0.25f;
  return params;
}

constexpr ElementKind kKinds[] = {ElementKind::vertex, ElementKind::triangle};

/// Every element with area has E = e / (1 - rho), but for 1 %; those without have none or that.
void expect_furnace(const scene::Scene& box, float rho, const HemicubeParams& params) {
  const Solution s = solved(box, params);
  ASSERT_GT(s.field.irradiance.size(), 100u);
  const float expected = 2 * kPi / (1 - rho);
  for (size_t i = 0; i < s.field.irradiance.size(); ++i) {
    const Rgb e = s.field.irradiance[i];
    ASSERT_TRUE(is_finite(e));
    if (s.field.receivers.area_m2[i] > 0)
      EXPECT_NEAR(e.x, expected, 0.01f * expected) << rho << " " << int(params.elements);
  }
}

// Shares of each hemisphere sum to 1 and light is the same everywhere, so only the exact direct
// light errs, by rounding, and the passes left out: 1e-4.
TEST(Hemicube, FurnaceIsExactAtEveryElement) {
  for (const float rho : {0.0f, 0.5f, 0.9f})
    for (const ElementKind kind : kKinds) {
      HemicubeParams params = small(kind);
      expect_furnace(scene::furnace_box({rho, rho, rho}, {2, 2, 2}), rho, params);
      params.smooth = true;
      expect_furnace(scene::furnace_box({rho, rho, rho}, {2, 2, 2}), rho, params);
    }
}

// More emitters than are sampled exactly: their light comes through the pixels.
TEST(Hemicube, FurnaceOfManyEmittersIsExact) {
  for (const ElementKind kind : kKinds)
    expect_furnace(scene::furnace_box({0.5f, 0.5f, 0.5f}, {2, 2, 2}, 4), 0.5f, small(kind));
}

// What files bring along. None of it changes the box's light.
TEST(BadMeshes, DegenerateTrianglesAndIsolatedVerticesChangeNothing) {
  for (const ElementKind kind : kKinds) {
    scene::Scene box = scene::furnace_box({0.5f, 0.5f, 0.5f}, {2, 2, 2});
    scene::Mesh& mesh = box.meshes[0];
    const auto lone = uint32_t(mesh.positions.size());
    for (const Vec3 p : {Vec3{0.2f, 0.2f, 0.2f}, {0.3f, 0.3f, 0.3f}, {0.4f, 0.4f, 0.4f}})
      mesh.positions.push_back(p);
    mesh.triangles.push_back({0, 0, 0});
    mesh.triangles.push_back({0, 1, 1});
    mesh.triangles.push_back({lone, lone, lone + 1});
    mesh.triangle_material.resize(mesh.triangles.size());
    HemicubeParams params = small(kind);
    expect_furnace(box, 0.5f, params);
    params.smooth = true;
    expect_furnace(box, 0.5f, params);
  }
  scene::Scene square = scene_of(unit_square());
  square.meshes[0].positions.push_back({7, 7, 7});
  EXPECT_EQ(mesh_of(square).vertices.size(), 4u);
}

TEST(BadMeshes, ZeroAndFlippedNormalsAreTheTrianglesOwn) {
  for (const ElementKind kind : kKinds)
    for (const float sign : {0.0f, -1.0f, NAN}) {
      scene::Scene box = scene::furnace_box({0.5f, 0.5f, 0.5f}, {2, 2, 2});
      const Vec3 centre = scene::world_bounds(box).centre();
      for (const Vec3& p : box.meshes[0].positions)
        box.meshes[0].normals.push_back(normalize(centre - p) * sign);
      expect_furnace(box, 0.5f, small(kind));
    }
}

TEST(BadMeshes, WithoutAnyAreaHaveNoLight) {
  scene::Mesh line;
  line.positions = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  line.triangles = {{0, 1, 2}, {1, 1, 1}};
  line.triangle_material = {0, 0};
  scene::Scene scene = scene_of(line);
  scene.background = {1, 1, 1};
  for (const ElementKind kind : kKinds) {
    HemicubeParams params = small(kind);
    for (const Rgb& e : solved(scene, params).field.irradiance) EXPECT_TRUE(is_finite(e));
    params.element_size_m = 0;
    for (const Rgb& e : solved(scene, params).field.irradiance) EXPECT_TRUE(is_finite(e));
  }
}

TEST(BadMeshes, WithoutTrianglesAreRefused) {
  scene::Scene scene = scene_of({});
  Progress progress;
  const auto s = try_to_solve(scene, {}, progress);
  ASSERT_FALSE(s);
  EXPECT_EQ(s.error().code, ErrorCode::bad_input);
}

// All black: E is the direct light alone, and one pass finds that out.
TEST(Hemicube, ABlackSceneHasDirectLight) {
  scene::Scene box = scene::cornell_box();
  for (scene::Material& m : box.materials) m.base_color = {0, 0, 0};
  for (const ElementKind kind : kKinds) {
    HemicubeParams params = small(kind);
    params.element_size_m = 0.1f;
    const Solution all = solved(box, params);
    params.bounces = 0;
    EXPECT_EQ(all.field.irradiance, solved(box, params).field.irradiance);
  }
}

TEST(Hemicube, TooFewElementsAreRefused) {
  Progress progress;
  const scene::Scene box = scene::cornell_box();
  HemicubeParams params;
  params.resolution = 4, params.max_elements = 5;
  const auto s = try_to_solve(box, params, progress);
  ASSERT_FALSE(s);
  EXPECT_EQ(s.error().code, ErrorCode::bad_setting);
  EXPECT_NE(s.error().message.find("--max-elements 5 "), std::string::npos) << s.error().message;
  // As many as there are: nothing is cut.
  params.max_elements = mesh_of(box).vertices.size();
  EXPECT_EQ(solved(box, params).field.irradiance.size(), params.max_elements);
  params.element_size_m = 0.05f;
  EXPECT_FALSE(try_to_solve(box, params, progress));
}

// A small cube of which a larger, solid one holds all but the top: what is hidden gets the light of
// what is not, and keeps being called hidden.
TEST(Hemicube, HiddenElementsTakeTheirNeighboursLight) {
  for (const ElementKind kind : kKinds) {
    scene::Mesh ground, post;
    scene::add_box(ground, {-2, -1, -2}, {2, 0, 2}, 0);
    scene::add_box(post, {-0.5f, -0.75f, -0.5f}, {0.5f, 0.25f, 0.5f}, 0);
    scene::Scene scene = scene_of(ground);
    scene::place(scene, std::move(post));
    scene.background = {1, 1, 1};
    HemicubeParams params = small(kind);
    params.max_error = 0, params.bounces = 0;
    const Solution s = solved(scene, params);
    int hidden = 0;
    for (size_t i = 0; i < s.hidden.size(); ++i) {
      const bool of_post = kind == ElementKind::vertex
                               ? s.field.mesh.vertices[i].instance == 1
                               : s.field.mesh.nodes[s.field.receivers.leaves[i]].instance == 1;
      const float y = s.field.receivers.elements.position[i].y;
      EXPECT_EQ(s.hidden[i], of_post && y < -0.01f) << y;
      hidden += s.hidden[i];
      // The post's walls see half of the sky; its bottom has no neighbour with light across its
      // crease and stays black.
      if (s.hidden[i] && y > -0.74f) {
        EXPECT_NEAR(s.field.irradiance[i].x, kPi / 2, 0.35f);
      }
    }
    EXPECT_GT(hidden, 30);
  }
}

}  // namespace
}  // namespace luxel::hemicube
