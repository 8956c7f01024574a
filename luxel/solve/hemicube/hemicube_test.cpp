#include "luxel/solve/hemicube/hemicube.h"

#include <gtest/gtest.h>

#include "luxel/solve/hemicube/hemicube_test_support.h"

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
    if (s.field.receivers.area_m2[i] > 0) {
      EXPECT_NEAR(e.x, expected, 0.01f * expected) << rho << " " << int(params.elements);
    }
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

// Files bring such triangles and vertices along. None of them changes the box's light.
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

/// Three vertices of its own for each triangle, all with the triangle's normal, times `sign`.
scene::Mesh with_own_normals(const scene::Scene& scene, float sign) {
  const scene::Mesh& mesh = scene.meshes[0];
  scene::Mesh out;
  for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto first = uint32_t(out.positions.size());
    for (const uint32_t v : mesh.triangles[t]) {
      out.positions.push_back(mesh.positions[v]);
      out.normals.push_back(scene::front_normal(scene, 0, t) * sign);
    }
    out.triangles.push_back({first, first + 1, first + 2});
  }
  out.triangle_material = mesh.triangle_material;
  return out;
}

TEST(BadMeshes, ZeroAndFlippedNormalsAreTheTrianglesOwn) {
  for (const ElementKind kind : kKinds)
    for (const float sign : {1.0f, 0.0f, -1.0f}) {
      scene::Scene box = scene::furnace_box({0.5f, 0.5f, 0.5f}, {2, 2, 2});
      box.meshes[0] = with_own_normals(box, sign);
      EXPECT_EQ(mesh_of(box).vertices.size(), 24u);
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
    params.element_size_m = 0.1f, params.max_elements = 1500;
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

// A post stands in solid ground: what is in the ground, and the ground in the post, gets the light
// of what is not, and keeps being called hidden.
TEST(Hemicube, HiddenElementsTakeTheirNeighboursLight) {
  for (const ElementKind kind : kKinds) {
    scene::Mesh ground, post;
    scene::add_box(ground, {-2, -1, -2}, {2, 0, 2}, 0);
    scene::add_box(post, {-0.45f, -0.8f, -0.45f}, {0.45f, 0.3f, 0.45f}, 0);
    scene::Scene scene = scene_of(ground);
    scene::place(scene, std::move(post));
    scene.background = {1, 1, 1};
    HemicubeParams params = small(kind);
    params.max_error = 0, params.bounces = 0, params.element_size_m = 0.15f;
    const Solution s = solved(scene, params);
    int in_ground = 0, in_post = 0;
    for (size_t i = 0; i < s.hidden.size(); ++i) {
      const Vec3 p = s.field.receivers.elements.position[i];
      const Vec3 n = s.field.receivers.elements.normal[i];
      const bool of_post = kind == ElementKind::vertex
                               ? s.field.mesh.vertices[i].instance == 1
                               : s.field.mesh.nodes[s.field.receivers.leaves[i]].instance == 1;
      const bool below = of_post && p.y < 0;
      const bool within = !of_post && n.y > 0.5f && std::max(std::abs(p.x), std::abs(p.z)) < 0.45f;
      EXPECT_EQ(s.hidden[i], below || within) << p.x << " " << p.y << " " << p.z;
      // Walls see half of the sky, the ground at the foot of the post 50 to 80 % of it. The post's
      // bottom has no neighbour with light across its creases.
      const float e = s.field.irradiance[i].x;
      if (below && n.y < -0.5f) {
        EXPECT_EQ(e, 0);
      }
      if (below && n.y > -0.5f) {
        EXPECT_NEAR(e, kPi / 2, 0.3f);
        ++in_ground;
      }
      if (within) {
        EXPECT_NEAR(e, 0.66f * kPi, 0.5f);
        ++in_post;
      }
    }
    EXPECT_GT(in_ground, 50);
    EXPECT_GT(in_post, 20);
  }
}

}  // namespace
}  // namespace luxel::hemicube
