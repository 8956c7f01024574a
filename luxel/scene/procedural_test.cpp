#include "luxel/scene/procedural.h"

#include <gtest/gtest.h>

#include <map>
#include <set>
#include <sstream>

#include "luxel/scene/shapes.h"
#include "tests/reference_data.h"
#include "tests/surfaces.h"

namespace luxel::scene {
namespace {

using namespace testing_support;

const char* const kFacts = "reference/cornell-box.md";

struct DVec {
  double x, y, z;
};

/// One row of the facts' table of quads.
struct FactQuad {
  std::string surface, material;
  std::array<DVec, 4> corners_mm;
};

DVec triple_of(const std::string& text) {
  std::stringstream in(text);
  DVec v{};
  in >> v.x >> v.y >> v.z;
  EXPECT_TRUE(bool(in)) << text;
  return v;
}

std::vector<FactQuad> fact_quads() {
  std::vector<FactQuad> quads;
  for (const auto& cells : testing_support::markdown_rows(kFacts, "Geometry", "surface"))
    quads.push_back(
        {cells[0],
         cells[1],
         {triple_of(cells[2]), triple_of(cells[3]), triple_of(cells[4]), triple_of(cells[5])}});
  return quads;
}

/// The vector area of a polygon in space: half the sum of the cross products of its corners. It
/// depends only on the boundary, so it is the same for every triangulation, bent ones too.
DVec vector_area(const std::vector<DVec>& p) {
  DVec s{};
  for (size_t i = 0; i < p.size(); ++i) {
    const DVec a = p[i], b = p[(i + 1) % p.size()];
    s.x += 0.5 * (a.y * b.z - a.z * b.y);
    s.y += 0.5 * (a.z * b.x - a.x * b.z);
    s.z += 0.5 * (a.x * b.y - a.y * b.x);
  }
  return s;
}

DVec wide(Vec3 v) { return {v.x, v.y, v.z}; }

// Every quad of the published list is there with all four corners, in the right material and facing
// the lit side: the vector area of each surface's rows equals that of its triangles.
TEST(CornellBox, EverySurfaceOfThePublishedListIsThere) {
  const auto quads = fact_quads();
  ASSERT_EQ(quads.size(), 16u);
  const Scene scene = cornell_box();
  expect_consistent(scene);

  std::map<std::string, std::vector<FactQuad>> surfaces;
  for (const FactQuad& q : quads) {
    const bool top = q.surface.ends_with(" top");
    surfaces[top ? q.surface.substr(0, q.surface.size() - 4) : q.surface].push_back(q);
  }
  EXPECT_EQ(scene.instances.size(), surfaces.size());
  for (const auto& [name, rows] : surfaces) {
    const uint32_t instance = instance_named(scene, name);
    const Mesh& mesh = scene.meshes[scene.instances[instance].mesh];
    std::set<std::array<double, 3>> corners;
    DVec expected{};
    for (const FactQuad& q : rows) {
      const DVec a = vector_area({q.corners_mm.begin(), q.corners_mm.end()});
      expected = {expected.x + a.x, expected.y + a.y, expected.z + a.z};
      for (const DVec& c : q.corners_mm) {
        bool found = false;
        for (const Vec3& p : mesh.positions)
          found |=
              length(p - Vec3{float(c.x * 1e-3), float(c.y * 1e-3), float(c.z * 1e-3)}) < 1e-6f;
        EXPECT_TRUE(found) << name << " misses " << c.x << ' ' << c.y << ' ' << c.z;
        corners.insert({c.x, c.y, c.z});
      }
    }
    if (name == "ceiling") expected.y += 130.0 * 105.0;  // it faces down; the hole takes this away
    DVec sum{};
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      const Triangle3 w = world_triangle(scene, instance, t);
      const DVec a = vector_area({wide(w.a), wide(w.b), wide(w.c)});
      sum = {sum.x + a.x, sum.y + a.y, sum.z + a.z};
      const std::string material = rows[0].material == "lamp" ? "light" : rows[0].material;
      EXPECT_EQ(scene.materials[mesh.triangle_material[t]].name, material) << name;
    }
    EXPECT_EQ(mesh.positions.size(), corners.size() + (name == "ceiling" ? 4 : 0)) << name;
    EXPECT_NEAR(sum.x, expected.x * 1e-6, 1e-6) << name;
    EXPECT_NEAR(sum.y, expected.y * 1e-6, 1e-6) << name;
    EXPECT_NEAR(sum.z, expected.z * 1e-6, 1e-6) << name;
  }
}

// Vector areas alone would not see one face turned over against another of the same block: the
// front of each block face looks away from the block's middle.
TEST(CornellBox, BlockFacesLookOutwards) {
  const Scene scene = cornell_box();
  for (const char* name : {"short block", "tall block"}) {
    const uint32_t instance = instance_named(scene, name);
    const Mesh& mesh = scene.meshes[scene.instances[instance].mesh];
    ASSERT_EQ(mesh.triangles.size(), 10u);
    Box3 box;
    for (const Vec3& p : mesh.positions) box.extend(p);
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      const Vec3 p = world_position(scene, {instance, t, {1 / 3.f, 1 / 3.f}});
      EXPECT_GT(dot(front_normal(scene, instance, t), p - box.centre()), 0.01f);
    }
  }
}

TEST(CornellBox, TheLampFillsTheHoleOfTheCeiling) {
  const Scene scene = cornell_box(CornellColors::pbrt, false);
  EXPECT_EQ(scene.instances.size(), 6u);
  const uint32_t light = instance_named(scene, "light"), ceiling = instance_named(scene, "ceiling");
  for (const uint32_t instance : {light, ceiling})
    for (uint32_t t = 0; t < scene.meshes[instance].triangles.size(); ++t) {
      EXPECT_NEAR(front_normal(scene, instance, t).y, -1, 1e-6);
      EXPECT_EQ(world_position(scene, {instance, t, {0.3f, 0.3f}}).y, 0.5488f);
    }
  double area[2] = {0, 0};
  for (int k = 0; k < 2; ++k)
    for (uint32_t t = 0; t < scene.meshes[k ? ceiling : light].triangles.size(); ++t)
      area[k] += double(area_m2(world_triangle(scene, k ? ceiling : light, t)));
  EXPECT_NEAR(area[0], 0.013650, 1e-8);
  EXPECT_NEAR(area[0] + area[1], 0.556 * 0.5592, 1e-7);
  // No triangle of the ceiling reaches into the hole: the areas above would allow an overlap that
  // makes up for a gap. Points of a grid in the hole lie in no triangle.
  for (int i = 1; i < 12; ++i)
    for (int j = 1; j < 12; ++j) {
      const Vec3 p{0.213f + 0.130f * float(i) / 12, 0.5488f, 0.227f + 0.105f * float(j) / 12};
      for (uint32_t t = 0; t < scene.meshes[ceiling].triangles.size(); ++t) {
        const Triangle3 w = world_triangle(scene, ceiling, t);
        const bool inside = cross(w.b - w.a, p - w.a).y < 0 && cross(w.c - w.b, p - w.b).y < 0 &&
                            cross(w.a - w.c, p - w.c).y < 0;
        EXPECT_FALSE(inside);
      }
    }
}

TEST(CornellBox, ColoursAreThoseOfTheTable) {
  const auto rows = testing_support::markdown_rows(kFacts, "Linear sRGB", "set");
  ASSERT_EQ(rows.size(), 3u);
  const std::map<char, CornellColors> sets{
      {'D', CornellColors::d65}, {'M', CornellColors::mitsuba}, {'P', CornellColors::pbrt}};
  for (const auto& cells : rows) {
    const CornellColors colors = sets.at(cells[0][0]);
    const Scene scene = cornell_box(colors);
    ASSERT_EQ(scene.materials.size(), 4u);
    for (const Material& m : scene.materials) {
      EXPECT_FALSE(m.double_sided);
      const bool lamp = m.name == "light";
      const Rgb have = lamp ? m.emission : m.base_color;
      if (lamp && colors == CornellColors::d65) {
        // No radiance in the data: neutral, with the luminance of set P's lamp.
        EXPECT_EQ(have, (Rgb{have.x, have.x, have.x}));
        EXPECT_NEAR(luminance(have), luminance({17, 12, 4}), 1e-4);
        continue;
      }
      const size_t column = lamp ? 4 : m.name == "white" ? 1 : m.name == "green" ? 2 : 3;
      const DVec c = triple_of(cells[column]);
      EXPECT_EQ(have, (Rgb{float(c.x), float(c.y), float(c.z)})) << cells[0] << m.name;
    }
  }
}

// The published camera: a point of the opening's rim at the edge of the film's field of view, and
// red on the left of the picture.
TEST(CornellBox, CameraIsThePublishedOne) {
  const Scene scene = cornell_box();
  ASSERT_EQ(scene.cameras.size(), 1u);
  const Camera& camera = scene.cameras[0];
  EXPECT_NEAR(camera.fov_y_rad * 180 / kPi, 39.3077, 1e-4);
  EXPECT_EQ(camera.aspect, 1);
  const Mat34& m = camera.world_from_camera;
  EXPECT_EQ(transform_point(m, {}), (Vec3{0.278f, 0.273f, -0.8f}));
  EXPECT_EQ(transform_vector(m, {0, 0, -1}), (Vec3{0, 0, 1}));
  EXPECT_EQ(transform_vector(m, {0, 1, 0}), (Vec3{0, 1, 0}));
  EXPECT_NEAR(determinant(m), 1, 1e-6);
  const Triangle3 red = world_triangle(scene, instance_named(scene, "left wall"), 0);
  EXPECT_LT(dot(red.a - Vec3{0.278f, 0.273f, -0.8f}, transform_vector(m, {1, 0, 0})), 0);
}

TEST(FurnaceBox, IsClosedOfSideOneAndFacesInwards) {
  for (const int n : {1, 2, 5, 8}) {
    const Scene scene = furnace_box({0.5f, 0.5f, 0.5f}, {1, 1, 1}, n);
    expect_consistent(scene);
    const auto triangles = triangles_of(scene);
    EXPECT_EQ(triangles.size(), size_t(6 * n * n * 2));
    expect_closed(triangles);
    EXPECT_NEAR(total_area(triangles), 6, 1e-5);
    EXPECT_NEAR(signed_volume(triangles), -1, 1e-5);
    for (uint32_t t = 0; t < triangles.size(); ++t) {
      const Vec3 inwards = world_bounds(scene).centre() - world_position(scene, {0, t, {.3f, .3f}});
      EXPECT_GT(dot(front_normal(scene, 0, t), inwards), 0.49f);
    }
  }
}

TEST(FurnaceBox, ReflectsAndEmitsWhatWasAsked) {
  const Scene scene = furnace_box({0.1f, 0.2f, 0.3f}, {4, 5, 6});
  EXPECT_EQ(reflectance_at(scene, {}), (Rgb{0.1f, 0.2f, 0.3f}));
  EXPECT_EQ(emission_at(scene, {}), (Rgb{4, 5, 6}));
}

TEST(InwardSphere, IsClosedRoundAndFacesInwards) {
  for (int levels = 0; levels <= 4; ++levels) {
    const float r = 2.5f;
    const Scene scene = inward_sphere(r, levels, {0.5f, 0.5f, 0.5f}, {1, 1, 1});
    expect_consistent(scene);
    const auto triangles = triangles_of(scene);
    EXPECT_EQ(triangles.size(), size_t(20) << (2 * levels));
    expect_closed(triangles);
    for (const Vec3& p : scene.meshes[0].positions) EXPECT_NEAR(length(p), r, 1e-6 * 2.5);
    for (uint32_t t = 0; t < triangles.size(); ++t) {
      const Vec3 p = world_position(scene, {0, t, {1 / 3.f, 1 / 3.f}});
      EXPECT_GT(dot(front_normal(scene, 0, t), -normalize(p)), 0.99f);
    }
    const double ball = 4.0 / 3 * M_PI * r * r * r, skin = 4 * M_PI * r * r;
    EXPECT_LT(-signed_volume(triangles), ball);
    EXPECT_LT(total_area(triangles), skin);
    if (levels == 4) {
      EXPECT_NEAR(-signed_volume(triangles), ball, 0.005 * ball);
      EXPECT_NEAR(total_area(triangles), skin, 0.005 * skin);
    }
  }
  // The regular icosahedron of circumradius 1 has the surface 5 sqrt(3) a^2, a = 4 / sqrt(10 + 2
  // sqrt(5)).
  const double a2 = 16 / (10 + 2 * std::sqrt(5.0));
  EXPECT_NEAR(total_area(triangles_of(inward_sphere(1, 0, {}, {}))), 5 * std::sqrt(3.0) * a2, 1e-5);
}

TEST(SpheresAndCube, HasTheTrianglesOfThePaper) {
  const Scene scene = spheres_and_cube();
  expect_consistent(scene);
  EXPECT_EQ(first_triangles(scene).back(), 478u);
  EXPECT_GT(scene.background.y, scene.background.x);
  EXPECT_GT(scene.background.y, scene.background.z);
  EXPECT_EQ(scene.cameras.size(), 1u);
}

TEST(SpheresAndCube, WallsFaceInwardsAndObjectsOutwards) {
  const Scene scene = spheres_and_cube();
  const Vec3 middle{0, 1, 0};
  for (const char* name : {"floor", "ceiling", "back wall", "left wall", "right wall", "light"}) {
    const uint32_t i = instance_named(scene, name);
    for (uint32_t t = 0; t < scene.meshes[i].triangles.size(); ++t)
      EXPECT_NEAR(
          dot(front_normal(scene, i, t), middle - world_position(scene, {i, t, {.3f, .3f}})), 1,
          1e-5)
          << name;
  }
  for (const char* name : {"red sphere", "yellow sphere", "cube"}) {
    const uint32_t i = instance_named(scene, name);
    std::vector<Triangle3> surface;
    const Vec3 centre = transform_point(scene.instances[i].world_from_object, {});
    for (uint32_t t = 0; t < scene.meshes[i].triangles.size(); ++t) {
      surface.push_back(world_triangle(scene, i, t));
      const SurfacePoint p{i, t, {.3f, .4f}};
      EXPECT_GT(dot(front_normal(scene, i, t), world_position(scene, p) - centre), 0.1f);
      // Smooth on the spheres, flat on the cube.
      const Vec3 smooth = normalize(world_position(scene, p) - centre);
      const Vec3 expected = name == std::string("cube") ? front_normal(scene, i, t) : smooth;
      EXPECT_GT(dot(shading_normal(scene, p), expected), 0.999f);
      // Floating: clear of the walls.
      for (const Vec3 c : {surface.back().a, surface.back().b, surface.back().c}) {
        EXPECT_LT(std::max(std::abs(c.x), std::abs(c.z)), 0.95f);
        EXPECT_TRUE(c.y > 0.05f && c.y < 1.95f);
      }
    }
    expect_closed(surface);
    EXPECT_GT(signed_volume(surface), 0);
  }
}

TEST(LookAt, PutsTheTargetInTheMiddle) {
  const Vec3 eye{1, 2, 3}, target{-2, 0.5f, 7};
  const Mat34 m = look_at(eye, target, {0, 1, 0});
  EXPECT_EQ(transform_point(m, {}), eye);
  EXPECT_LT(length(transform_vector(m, {0, 0, -1}) - normalize(target - eye)), 1e-6f);
  EXPECT_NEAR(transform_vector(m, {1, 0, 0}).y, 0, 1e-6);
  EXPECT_GT(transform_vector(m, {0, 1, 0}).y, 0);
  EXPECT_NEAR(determinant(m), 1, 1e-6);
}

}  // namespace
}  // namespace luxel::scene
