#include "luxel/viewfactor/merge_polygons.h"

#include <gtest/gtest.h>

#include "luxel/scene/procedural.h"
#include "luxel/scene/shapes.h"
#include "luxel/viewfactor/polygon_test_support.h"
#include "luxel/viewfactor/surfaces.h"

namespace luxel::viewfactor {
namespace {

using Triangle = std::array<DVec3, 3>;

double sum_of_areas(const std::vector<Polygon>& polygons) {
  double sum = 0;
  for (const Polygon& polygon : polygons) sum += area_m2(polygon);
  return sum;
}

/// n x n quads of the unit square, each as two triangles, lifted by height(x, y).
template <class Height>
std::vector<Triangle> grid(int n, const Height& height) {
  const auto at = [&](int i, int j) {
    const double x = double(i) / n, y = double(j) / n;
    return DVec3{x, y, height(x, y)};
  };
  std::vector<Triangle> triangles;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return triangles;
}

std::vector<Polygon> merged_of(const std::vector<Triangle>& triangles, double slack = 1e-9) {
  Progress progress;
  return merge_polygons(triangles, slack, progress)->polygons;
}

Surfaces surfaces_in(const scene::Scene& scene) {
  Progress progress;
  return *surfaces_of(scene, progress);
}

TEST(MergePolygons, AFlatGridIsOneSquare) {
  for (const int n : {1, 2, 3, 7, 12, 200}) {
    const std::vector<Triangle> triangles = grid(n, [](double, double) { return 0.25; });
    const std::vector<Polygon> merged = merged_of(triangles);
    ASSERT_EQ(merged.size(), 1u) << n;
    EXPECT_EQ(merged[0].size(), 4u);
    EXPECT_NEAR(area_m2(merged[0]), 1, 1e-12);
    EXPECT_NEAR(plane_of(merged[0]).normal.z, 1, 1e-12);
  }
}

// Corners of a turned grid are rounded to floats: its plane is known to 1e-7, and the planes of its
// small triangles to less.
TEST(MergePolygons, ATurnedGridOfFloatsIsOneSquareToo) {
  Dice dice;
  const Motion motion = dice.motion(3);
  std::vector<Triangle> triangles = grid(60, [](double, double) { return 0.0; });
  for (Triangle& t : triangles) {
    const Polygon turned = moved({t[0], t[1], t[2]}, motion);
    for (size_t k = 0; k < 3; ++k) t[k] = to_double(to_float(turned[k]));
  }
  const std::vector<Polygon> merged = merged_of(triangles, 4 * 0x1p-23 * 6);
  ASSERT_EQ(merged.size(), 1u);
  EXPECT_EQ(merged[0].size(), 4u);
  EXPECT_NEAR(area_m2(merged[0]), 9, 1e-5);
}

// The plane of neighbours differs by less than the slack, that of the whole does not.
TEST(MergePolygons, AGentlyBentSheetStaysWithinTheSlack) {
  const double slack = 1e-4;
  const std::vector<Triangle> sheet = grid(64, [](double x, double) { return 0.05 * x * x; });
  const std::vector<Polygon> merged = merged_of(sheet, slack);
  EXPECT_GT(merged.size(), 4u);
  EXPECT_LT(merged.size(), 64u);
  for (const Polygon& polygon : merged)
    for (const Triangle& t : sheet) {
      const DVec3 middle = (t[0] + t[1] + t[2]) * (1.0 / 3);
      Polygon shadow = polygon;
      for (DVec3& p : shadow) p.z = 0;
      bool inside = true;
      for (size_t i = 0; i < shadow.size(); ++i) {
        const DVec3 p = shadow[i], q = shadow[(i + 1) % shadow.size()];
        inside &= (q.x - p.x) * (middle.y - p.y) - (q.y - p.y) * (middle.x - p.x) > 0;
      }
      if (inside) {
        EXPECT_LT(std::abs(plane_of(polygon).height(middle)), 4 * slack);
      }
    }
}

TEST(MergePolygons, ASheetWithAHoleKeepsItsAreaInConvexParts) {
  constexpr int n = 30;
  std::vector<Triangle> triangles;
  for (const Triangle& t : grid(n, [](double, double) { return 0.0; })) {
    const DVec3 middle = (t[0] + t[1] + t[2]) * (1.0 / 3);
    if (std::max(std::abs(middle.x - 0.5), std::abs(middle.y - 0.5)) > 1.0 / 6)
      triangles.push_back(t);
  }
  const std::vector<Polygon> merged = merged_of(triangles);
  EXPECT_NEAR(sum_of_areas(merged), 1 - 1.0 / 9, 1e-12);
  EXPECT_LE(merged.size(), 8u);  // 4 are enough
  for (const Polygon& polygon : merged)
    for (size_t i = 0; i < polygon.size(); ++i) {
      const DVec3 p = polygon[i], q = polygon[(i + 1) % polygon.size()],
                  r = polygon[(i + 2) % polygon.size()];
      EXPECT_GT(cross(q - p, r - q).z, 0);
    }
}

// Four sheets meet in one edge: each goes on straight through it.
TEST(MergePolygons, SheetsThatCrossInAnEdgeGoOnStraight) {
  std::vector<Triangle> triangles;
  const auto add = [&](DVec3 a, DVec3 b, DVec3 c, DVec3 d) {
    triangles.push_back({a, b, c});
    triangles.push_back({a, c, d});
  };
  for (const double side : {-1.0, 0.0}) {
    add({side, 0, 0}, {side + 1, 0, 0}, {side + 1, 1, 0}, {side, 1, 0});
    add({0, 0, side}, {0, 1, side}, {0, 1, side + 1}, {0, 0, side + 1});
  }
  const std::vector<Polygon> merged = merged_of(triangles);
  ASSERT_EQ(merged.size(), 2u);
  for (const Polygon& polygon : merged) EXPECT_NEAR(area_m2(polygon), 2, 1e-12);
}

TEST(MergePolygons, CancelledWorkIsAnError) {
  Progress progress;
  progress.request_cancel();
  const auto merged = merge_polygons(grid(4, [](double, double) { return 0.0; }), 1e-9, progress);
  ASSERT_FALSE(merged.has_value());
  EXPECT_EQ(merged.error().code, ErrorCode::cancelled);
}

TEST(MergePolygons, KeepsAreaAndConvexityOnBentSurfaces) {
  const std::vector<Triangle> roof = grid(8, [](double x, double) { return x < 0.5 ? x : 1 - x; });
  EXPECT_EQ(merged_of(roof).size(), 2u);
  const std::vector<Triangle> bumpy = grid(8, [](double x, double y) { return x * x * y; });
  std::vector<Polygon> single;
  for (const Triangle& t : bumpy) single.push_back({t[0], t[1], t[2]});
  EXPECT_NEAR(sum_of_areas(merged_of(bumpy)), sum_of_areas(single), 1e-12);
}

TEST(MergePolygons, AnLShapeBecomesTwoConvexParts) {
  std::vector<Triangle> triangles = grid(2, [](double, double) { return 0.0; });
  triangles.erase(triangles.begin() + 6, triangles.end());  // without one quarter
  const std::vector<Polygon> merged = merged_of(triangles);
  EXPECT_EQ(merged.size(), 2u);
  EXPECT_NEAR(sum_of_areas(merged), 0.75, 1e-12);
  for (const Polygon& polygon : merged) EXPECT_EQ(polygon.size(), 4u);
}

TEST(MergePolygons, BackToBackAndDegenerateTrianglesStayApart) {
  const Triangle t{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}, back{{{0, 0, 0}, {0, 1, 0}, {1, 0, 0}}};
  const Triangle line{{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}};
  const std::vector<Triangle> triangles{t, back, line};
  EXPECT_EQ(merged_of(triangles).size(), 2u);
}

scene::Mesh square(const std::string& name) {
  scene::Mesh mesh;
  mesh.name = name;
  scene::add_quad(mesh, {{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}}, 0);
  return mesh;
}

TEST(Surfaces, NamesAreDistinctAndEmptySurfacesSaid) {
  scene::Scene scene;
  scene::add_material(scene, "gray", {0.5f, 0.5f, 0.5f});
  scene::place(scene, square("lamp"));
  scene::place(scene, square("lamp"));
  scene::place(scene, square("lamp#2"));
  scene::Mesh flat = square("flat");
  for (Vec3& p : flat.positions) p.y = 0;
  scene::place(scene, flat);
  const Surfaces surfaces = surfaces_in(scene);
  ASSERT_EQ(surfaces.surfaces.size(), 3u);
  EXPECT_EQ(surfaces.surfaces[0].name, "lamp");
  EXPECT_EQ(surfaces.surfaces[1].name, "lamp#2");
  EXPECT_EQ(surfaces.surfaces[2].name, "lamp#2#2");
  EXPECT_EQ(surfaces.of_instance, (std::vector<uint32_t>{0, 1, 2, scene::kNone}));
  ASSERT_EQ(surfaces.warnings.size(), 1u);
  EXPECT_NE(surfaces.warnings[0].find("'flat'"), std::string::npos);
}

TEST(Surfaces, MirroredInstancesKeepTheirFront) {
  scene::Scene scene;
  scene::add_material(scene, "gray", {0.5f, 0.5f, 0.5f});
  scene::place(scene, square("plain"));
  scene::place(scene, square("mirrored"), scaling({-2, 1, 1}));
  const Surfaces surfaces = surfaces_in(scene);
  for (const Surface& surface : surfaces.surfaces) {
    ASSERT_EQ(surface.polygons.size(), 1u);
    EXPECT_NEAR(plane_of(surface.polygons[0]).normal.z, 1, 1e-12) << surface.name;
  }
  EXPECT_NEAR(surfaces.surfaces[1].area_m2, 2, 1e-12);
}

}  // namespace
}  // namespace luxel::viewfactor
