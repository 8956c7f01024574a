#include "transport/merge_polygons.h"

#include <gtest/gtest.h>

#include "scene/procedural.h"
#include "scene/shapes.h"
#include "transport/polygon_test_support.h"
#include "transport/surfaces.h"

namespace luxel::transport {
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

TEST(MergePolygons, AFlatGridIsOneSquare) {
  for (const int n : {1, 2, 3, 7, 12}) {
    const std::vector<Triangle> triangles = grid(n, [](double, double) { return 0.25; });
    const std::vector<Polygon> merged = merge_polygons(triangles, 1e-9);
    ASSERT_EQ(merged.size(), 1u) << n;
    EXPECT_EQ(merged[0].size(), 4u);
    EXPECT_NEAR(area_m2(merged[0]), 1, 1e-12);
    EXPECT_NEAR(plane_of(merged[0]).normal.z, 1, 1e-12);
  }
}

TEST(MergePolygons, KeepsAreaAndConvexityOnBentSurfaces) {
  const std::vector<Triangle> roof = grid(8, [](double x, double) { return x < 0.5 ? x : 1 - x; });
  EXPECT_EQ(merge_polygons(roof, 1e-9).size(), 2u);
  const std::vector<Triangle> bumpy = grid(8, [](double x, double y) { return x * x * y; });
  std::vector<Polygon> single;
  for (const Triangle& t : bumpy) single.push_back({t[0], t[1], t[2]});
  EXPECT_NEAR(sum_of_areas(merge_polygons(bumpy, 1e-9)), sum_of_areas(single), 1e-12);
}

TEST(MergePolygons, AnLShapeBecomesTwoConvexParts) {
  std::vector<Triangle> triangles = grid(2, [](double, double) { return 0.0; });
  triangles.erase(triangles.begin() + 6, triangles.end());  // without one quarter
  const std::vector<Polygon> merged = merge_polygons(triangles, 1e-9);
  EXPECT_EQ(merged.size(), 2u);
  EXPECT_NEAR(sum_of_areas(merged), 0.75, 1e-12);
  for (const Polygon& polygon : merged) EXPECT_EQ(polygon.size(), 4u);
}

TEST(MergePolygons, BackToBackAndDegenerateTrianglesStayApart) {
  const Triangle t{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}, back{{{0, 0, 0}, {0, 1, 0}, {1, 0, 0}}};
  const Triangle line{{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}};
  const std::vector<Triangle> triangles{t, back, line};
  EXPECT_EQ(merge_polygons(triangles, 1e-9).size(), 2u);
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
  const Surfaces surfaces = surfaces_of(scene);
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
  const Surfaces surfaces = surfaces_of(scene);
  for (const Surface& surface : surfaces.surfaces) {
    ASSERT_EQ(surface.polygons.size(), 1u);
    EXPECT_NEAR(plane_of(surface.polygons[0]).normal.z, 1, 1e-12) << surface.name;
  }
  EXPECT_NEAR(surfaces.surfaces[1].area_m2, 2, 1e-12);
}

}  // namespace
}  // namespace luxel::transport
