#include "luxel/viewfactor/point_form_factor.h"

#include <gtest/gtest.h>

#include <array>

#include "tests/reference_data.h"

namespace luxel::viewfactor {
namespace {

namespace shared = luxel::testing_support;

TEST(PointToPolygon, MatchesTheExactTable) {
  int checked = 0;
  for (const auto& row : shared::csv_rows("reference/view-factors.csv")) {
    if (row[1] != "point" || !row[4].empty()) continue;
    const std::vector<Vec3> at = shared::parse_points(row[2]);
    const std::vector<Vec3> polygon = shared::parse_points(row[3]);
    const double exact = std::stod(row[5]);
    // Corners are floats here: 6e-8 of their size each, which the factor passes on.
    EXPECT_NEAR(point_to_polygon(at[0], normalize(at[1]), polygon), exact, 1e-6 * exact + 1e-9)
        << row[0];
    ++checked;
  }
  EXPECT_GE(checked, 3);
}

TEST(PointToPolygon, TheOtherSideOfThePolygonGivesNothing) {
  const std::array<Vec3, 4> up{{{-1, 1, 1}, {-1, -1, 1}, {1, -1, 1}, {1, 1, 1}}};
  const std::array<Vec3, 4> down{{{1, 1, 1}, {1, -1, 1}, {-1, -1, 1}, {-1, 1, 1}}};
  EXPECT_GT(
      point_to_polygon({0, 0, 0}, {0, 0, 1}, down) + point_to_polygon({0, 0, 0}, {0, 0, 1}, up),
      0.1);
  EXPECT_EQ(std::min(point_to_polygon({0, 0, 0}, {0, 0, 1}, down),
                     point_to_polygon({0, 0, 0}, {0, 0, 1}, up)),
            0.0);
}

// A polygon cut by the horizon counts as its upper part alone.
TEST(PointToPolygon, ClipsAtTheHorizon) {
  const std::array<Vec3, 4> whole{{{1, -1, -1}, {1, 1, -1}, {1, 1, 1}, {1, -1, 1}}};
  const std::array<Vec3, 4> upper{{{1, -1, 0}, {1, 1, 0}, {1, 1, 1}, {1, -1, 1}}};
  std::array<Vec3, 4> whole_turned = whole, upper_turned = upper;
  std::reverse(whole_turned.begin(), whole_turned.end());
  std::reverse(upper_turned.begin(), upper_turned.end());
  const double a = point_to_polygon({0, 0, 0}, {0, 0, 1}, whole) +
                   point_to_polygon({0, 0, 0}, {0, 0, 1}, whole_turned);
  const double b = point_to_polygon({0, 0, 0}, {0, 0, 1}, upper) +
                   point_to_polygon({0, 0, 0}, {0, 0, 1}, upper_turned);
  EXPECT_GT(a, 0.05);
  EXPECT_NEAR(a, b, 1e-12);
}

// The six faces of a cube around the point close its sphere: the factors of a half space sum to 1.
TEST(PointToPolygon, AClosedCubeAroundThePointSumsToOne) {
  const Vec3 point{0.1f, -0.2f, 0.3f};
  const Vec3 normal = normalize(Vec3{1, 2, 3});
  double sum = 0;
  for (int axis = 0; axis < 3; ++axis)
    for (const float side : {-1.0f, 1.0f}) {
      const auto corner = [&](float s, float t) {
        std::array<float, 3> p{};
        p[size_t(axis)] = side, p[size_t((axis + 1) % 3)] = s,
        p[size_t((axis + 2) % 3)] = t * -side;
        return Vec3{p[0], p[1], p[2]};
      };
      const std::array<Vec3, 4> face{corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1)};
      sum += point_to_polygon(point, normal, face);
    }
  EXPECT_NEAR(sum, 1.0, 1e-7);
}

}  // namespace
}  // namespace luxel::viewfactor
