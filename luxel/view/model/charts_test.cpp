// Sheets and boxes whose charts, seams and overlaps are known by construction.
#include "luxel/view/model/charts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <random>

#include "luxel/view/model/uv_overlaps.h"

namespace luxel::view {
namespace {

/// A square of `side` x `side` cells, each with corners of its own. A cell lies in the lightmap
/// where it lies on the sheet, moved by the number of its piece.
scene::Mesh sheet_of(int side, const std::vector<int>& piece) {
  scene::Mesh mesh;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      const auto first = uint32_t(mesh.positions.size());
      const float moved = 100 * float(piece[size_t(y * side + x)]);
      for (const auto& [dx, dy] : {std::pair(0, 0), {1, 0}, {1, 1}, {0, 1}}) {
        mesh.positions.push_back({float(x + dx), float(y + dy), 0});
        mesh.uv1.push_back({float(x + dx) + moved, float(y + dy)});
      }
      mesh.triangles.push_back({first, first + 1, first + 2});
      mesh.triangles.push_back({first, first + 2, first + 3});
    }
  mesh.triangle_material.assign(mesh.triangles.size(), 0);
  return mesh;
}

MeshCharts charts_in(const scene::Mesh& mesh) { return charts_of(mesh, mesh.uv1); }

int seams_of(const MeshCharts& charts) {
  int out = 0;
  for (const uint8_t bits : charts.seams) out += std::popcount(bits);
  return out;
}

/// Gives all cells of a piece that hang together one number.
void flood(int side, const std::vector<int>& piece, int cell, int number, std::vector<int>& out) {
  if (out[size_t(cell)] >= 0) return;
  out[size_t(cell)] = number;
  const int x = cell % side, y = cell / side;
  for (const auto& [dx, dy] : {std::pair(-1, 0), {1, 0}, {0, -1}, {0, 1}}) {
    const bool is_there = x + dx >= 0 && x + dx < side && y + dy >= 0 && y + dy < side;
    const int other = cell + dy * side + dx;
    if (is_there && piece[size_t(other)] == piece[size_t(cell)])
      flood(side, piece, other, number, out);
  }
}

TEST(Charts, AreThePiecesThatHangTogether) {
  constexpr int kSheet = 12;
  std::mt19937 random(7);
  for (int run = 0; run < 20; ++run) {
    std::vector<int> piece(kSheet * kSheet), island(kSheet * kSheet, -1);
    for (int& p : piece) p = int(random() % 3);
    int islands = 0, cuts = 0;
    for (int cell = 0; cell < kSheet * kSheet; ++cell) {
      if (island[size_t(cell)] < 0) flood(kSheet, piece, cell, islands++, island);
      const bool has_right = cell % kSheet + 1 < kSheet, has_below = cell / kSheet + 1 < kSheet;
      cuts += has_right && piece[size_t(cell)] != piece[size_t(cell + 1)];
      cuts += has_below && piece[size_t(cell)] != piece[size_t(cell + kSheet)];
    }
    const MeshCharts charts = charts_in(sheet_of(kSheet, piece));
    EXPECT_EQ(charts.charts, uint32_t(islands));
    EXPECT_EQ(seams_of(charts), 2 * cuts) << "both sides of each cut";
    for (size_t a = 0; a < piece.size(); ++a)
      for (size_t b = 0; b < a; ++b)
        ASSERT_EQ(charts.chart_of[2 * a] == charts.chart_of[2 * b + 1], island[a] == island[b]);
  }
}

// The border of a sheet is no seam: nothing lies beyond it.
TEST(Charts, SeamsLieAcrossFromTheirCorners) {
  const MeshCharts charts = charts_in(sheet_of(2, {0, 1, 0, 1}));
  EXPECT_EQ(charts.charts, 2u);
  // The right edge of a left cell is that of its first triangle from the second to the third
  // corner.
  EXPECT_EQ(charts.seams, (std::vector<uint8_t>{1, 0, 0, 2, 1, 0, 0, 2}));
  EXPECT_EQ(seams_of(charts_in(sheet_of(2, {5, 5, 5, 5}))), 0);
  EXPECT_EQ(charts_in(scene::Mesh()).charts, 0u);
}

TEST(UvOverlaps, AreWhereTwoSurfacesShareThePlace) {
  scene::Scene scene;
  scene.materials.resize(1);
  scene.meshes.push_back(sheet_of(2, {0, 0, 0, 0}));
  scene.instances.resize(1);
  pipeline::LightmapPages pages;
  pages.pictures.emplace_back(10, 10, 4);
  pages.of_material = {0};
  const auto shared_pixels = [&] {
    const image::Image8 picture = uv_overlaps(scene, pages, {}).front();
    EXPECT_EQ(picture.width, 20);
    return std::count(picture.data.begin(), picture.data.end(), 255);
  };
  // Half of the picture each way, and no pixel's middle on a diagonal.
  for (Vec2& uv : scene.meshes[0].uv1) uv = uv * 0.25f + Vec2{0.01f, 0};
  EXPECT_EQ(shared_pixels(), 0) << "edges in common are not shared places";
  // The second cell is moved over the first by half of its width.
  for (size_t i = 4; i < 8; ++i) scene.meshes[0].uv1[i].x -= 0.1f;
  EXPECT_EQ(shared_pixels(), 2 * 5) << "2 of 20 columns, 5 of 20 rows";
  scene.instances.resize(2);
  EXPECT_EQ(shared_pixels(), 8 * 5 + 10 * 5) << "all that is covered";
  scene.materials[0].unlit = true;
  EXPECT_EQ(shared_pixels(), 0);
}

}  // namespace
}  // namespace luxel::view
