#include "luxel/atlas/charts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "luxel/scene/grid.h"

namespace luxel::atlas {
namespace {

constexpr double kMaxAngle = 0.8;

/// A sheet of 2 n^2 triangles, one metre wide, at heights (x, z).
template <class Height>
Faces sheet(int n, const Height& height) {
  scene::Scene scene;
  scene::Mesh mesh;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) {
      const double x = double(i) / n, z = double(j) / n;
      mesh.positions.push_back({float(x), float(height(x, z)), float(z)});
    }
  scene::add_grid_triangles(mesh, n);
  scene.materials.emplace_back();
  scene.meshes.push_back(std::move(mesh));
  scene.instances.emplace_back();
  return make_faces(scene);
}

double widest_angle(const Faces& faces, const std::vector<ChartFaces>& charts) {
  double widest = 0;
  for (const ChartFaces& chart : charts)
    for (const uint32_t f : chart)
      widest = std::max(widest, angle_between(faces.normal[f], chart_axis(faces, chart)));
  return widest;
}

// Charts of hundreds of patches, of whose normals only the outermost are remembered while they
// grow: none of all lies too far from its axis.
TEST(Charts, KeepAllNormalsNearTheirAxes) {
  const Faces bumps = sheet(60, [](double x, double z) {
    return 0.12 * std::sin(9 * x + 2 * z) * std::cos(7 * z - x) + 0.02 * std::sin(31 * x * z);
  });
  Progress progress;
  const std::vector<ChartFaces> charts = grow_charts(bumps, kMaxAngle, progress);
  // Patches are flat within a hundredth.
  EXPECT_LE(widest_angle(bumps, charts), kMaxAngle + 0.01);
  EXPECT_LT(charts.size(), bumps.size() / 100);
  // It comes near to the limit: else nothing was put to the test.
  EXPECT_GT(widest_angle(bumps, charts), 0.9 * kMaxAngle);
}

// Normals of a surface that bends in one direction lie on a line, and many of them are equal.
TEST(Charts, OfCorrugatedSheetsKeepTheirNormalsToo) {
  const Faces waves =
      sheet(80, [](double x, double) { return 0.09 * std::sin(6 * 2 * kPiDouble * x); });
  Progress progress;
  const std::vector<ChartFaces> charts = grow_charts(waves, kMaxAngle, progress);
  EXPECT_LE(widest_angle(waves, charts), kMaxAngle + 0.01);
  // A wave's two flanks differ by more than a chart may hold: at least one chart each.
  EXPECT_GE(charts.size(), 12u);
  EXPECT_LE(charts.size(), 26u);
}

}  // namespace
}  // namespace luxel::atlas
