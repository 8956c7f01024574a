#include "luxel/viewfactor/polygon_form_factor.h"

#include <gtest/gtest.h>

#include <chrono>
#include <ctime>

#include "luxel/viewfactor/point_form_factor.h"
#include "luxel/viewfactor/polygon_test_support.h"
#include "tests/reference_data.h"

namespace luxel::viewfactor {
namespace {

namespace shared = luxel::testing_support;

TEST(PolygonFormFactor, MatchesTheExactTable) {
  int polygons = 0, points = 0;
  for (const auto& row : shared::csv_rows("reference/view-factors.csv")) {
    if (!row[4].empty()) continue;
    const Polygon a = shared::parse_polygon(row[2]), b = shared::parse_polygon(row[3]);
    const double exact = std::stod(row[5]);
    if (row[1] == "poly") {
      EXPECT_NEAR(polygon_form_factor(a, b), exact, 1e-11 * exact) << row[0];
      ++polygons;
    } else {
      EXPECT_NEAR(point_to_polygon(a[0], a[1], b), exact, 1e-13) << row[0];
      ++points;
    }
  }
  EXPECT_GE(polygons, 30);
  EXPECT_GE(points, 6);
}

/// Arrangement of the polygons of a pair.
struct PairCase {
  const char* name;
  double size_a, size_b, apart;
  bool share_corner, share_edge;
  double tolerance;
};
std::ostream& operator<<(std::ostream& out, const PairCase& c) { return out << c.name; }

struct Pairs : testing::TestWithParam<PairCase> {
  std::pair<Polygon, Polygon> draw(Dice& dice) const {
    const PairCase& c = GetParam();
    const DVec3 o = dice.point();
    if (c.share_edge) {
      const DVec3 edge = dice.point();
      const DVec3 u = dice.normal_to(edge) * c.size_a, v = dice.normal_to(edge) * c.size_b;
      return {{o, o + edge, o + edge + u, o + u}, {o + edge, o, o + v, o + edge + v}};
    }
    const DVec3 other = c.share_corner ? o : dice.point() + DVec3{c.apart, 0, 0};
    return {dice.rectangle(o, c.size_a), dice.rectangle(other, c.size_b)};
  }
};
INSTANTIATE_TEST_SUITE_P(PolygonFormFactor, Pairs,
                         testing::Values(PairCase{"near", 1, 1, 0, false, false, 1e-10},
                                         PairCase{"apart", 1, 1, 5, false, false, 1e-11},
                                         PairCase{"far", 1, 1, 1e4, false, false, 1e-10},
                                         PairCase{"small_to_large", 1e-3, 1, 0, false, false, 1e-8},
                                         PairCase{"large_to_small", 1, 1e-3, 0, false, false, 1e-8},
                                         PairCase{"corner", 1, 1, 0, true, false, 1e-9},
                                         PairCase{"edge", 1, 1, 0, false, true, 1e-10},
                                         PairCase{"long_edge", 0.01, 1, 0, false, true, 1e-9}));

/// Errors are measured against the smallest factor that says something.
double relative(double a, double b, double least) { return std::abs(a - b) / std::max(b, least); }
constexpr double kLeast = 1e-4;

// A_a F(a -> b) = A_b F(b -> a), and a polygon's factor is the sum over its two halves: both ways
// of the two polygons.
TEST_P(Pairs, AreReciprocalAndAdditive) {
  Dice dice;
  int with_light = 0;
  for (int i = 0; i < 300; ++i) {
    const auto [a, b] = draw(dice);
    const double forth = polygon_exchange_area(a, b).value;
    const double least = kLeast * std::min(area_m2(a), area_m2(b)) /
                         std::max(1.0, GetParam().apart * GetParam().apart);
    EXPECT_LT(relative(polygon_exchange_area(b, a).value, forth, least), GetParam().tolerance);
    double parts_of_a = 0, parts_of_b = 0;
    for (const Polygon& part : halves(a, dice)) parts_of_a += polygon_exchange_area(part, b).value;
    for (const Polygon& part : halves(b, dice)) parts_of_b += polygon_exchange_area(a, part).value;
    EXPECT_LT(relative(parts_of_a, forth, least), GetParam().tolerance) << i;
    EXPECT_LT(relative(parts_of_b, forth, least), GetParam().tolerance) << i;
    with_light += forth > least;
  }
  EXPECT_GT(with_light, 40);
}

// Turning, moving and scaling both polygons changes nothing.
TEST_P(Pairs, AreTheSameInAnyPlaceAndUnit) {
  Dice dice;
  for (int i = 0; i < 100; ++i) {
    const auto [a, b] = draw(dice);
    const double factor = polygon_form_factor(a, b);
    for (const double scale : {1e-3, 1.0, 1e3}) {
      const Motion motion = dice.motion(scale);
      const double least = kLeast / std::max(1.0, GetParam().apart * GetParam().apart) *
                           std::min(1.0, area_m2(b) / area_m2(a));
      EXPECT_LT(relative(polygon_form_factor(moved(a, motion), moved(b, motion)), factor, least),
                10 * GetParam().tolerance);
    }
  }
}

// Closed in a convex room, everything that a wall radiates arrives at the others.
TEST(PolygonFormFactor, RowsOfConvexPolyhedraSumToOne) {
  Dice dice;
  for (int i = 0; i < 40; ++i) {
    const std::vector<Polygon> faces = dice.convex_room(4 + i % 12);
    for (const Polygon& from : faces) {
      double sum = 0;
      for (const Polygon& to : faces)
        if (&to != &from) sum += polygon_form_factor(from, to);
      EXPECT_NEAR(sum, 1, 1e-9) << faces.size() << " faces, area " << area_m2(from);
    }
  }
}

TEST(PolygonFormFactor, OnePlaneGivesExactlyNothing) {
  Dice dice;
  const Polygon square{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  const Polygon beside{{1, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}};
  const Polygon over{{0.5, 0.5, 0}, {2, 0.5, 0}, {2, 2, 0}};
  Polygon turned = square;
  std::reverse(turned.begin(), turned.end());
  for (int i = 0; i < 100; ++i) {
    const Motion motion = dice.motion(1);
    for (const Polygon& other : {square, beside, over, turned})
      EXPECT_EQ(polygon_form_factor(moved(square, motion), moved(other, motion)), 0.0);
  }
}

TEST(PolygonFormFactor, BacksAndPolygonsWithoutAreaGiveExactlyNothing) {
  const Polygon floor{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  const Polygon back{{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
  const Polygon line{{0, 0, 1}, {1, 0, 1}, {0.5, 0, 1}}, point{{0, 0, 1}, {0, 0, 1}, {0, 0, 1}};
  for (const Polygon& other : {back, line, point}) {
    EXPECT_EQ(polygon_form_factor(floor, other), 0.0);
    EXPECT_EQ(polygon_form_factor(other, floor), 0.0);
  }
}

// The strip of a wall along its edge with the floor, ever thinner: F(strip -> floor) tends to that
// of the strip's points, (1 - cos 90 degrees) / 2 = 1/2 in the middle of a long edge.
TEST(PolygonFormFactor, SliversKeepTheirFactor) {
  for (const double width : {1e-3, 1e-5, 1e-7}) {
    const Polygon floor{{0, -1000, 0}, {1000, -1000, 0}, {1000, 1000, 0}, {0, 1000, 0}};
    const Polygon strip{{0, -1, 0}, {0, 1, 0}, {0, 1, width}, {0, -1, width}};
    EXPECT_NEAR(polygon_form_factor(strip, floor), 0.5, 1e-6 + width) << width;
  }
}

TEST(PolygonFormFactor, KeepsItsPrecisionOverAnyDistance) {
  const Polygon a{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  for (const double r : {1e3, 1e5, 1e7, 1e9}) {
    const Polygon b{{0, 1, r}, {1, 1, r}, {1, 0, r}, {0, 0, r}};
    // Points d apart sideways: r^2 / (pi (r^2 + d^2)^2), and d^2 is 1/3 in the mean.
    EXPECT_NEAR(polygon_form_factor(a, b) * kPiDouble * r * r, 1 - 2 / (3 * r * r), 1e-11) << r;
  }
}

TEST(PolygonFormFactor, IsFastAlsoWherePolygonsTouch) {
  Dice dice;
  std::vector<std::pair<Polygon, Polygon>> pairs;
  while (pairs.size() < 500) {
    const DVec3 o = dice.point(), edge = dice.point();
    const DVec3 u = dice.normal_to(edge), v = dice.normal_to(edge);
    const Polygon a{o, o + edge, o + edge + u, o + u}, b{o + edge, o, o + v, o + edge + v};
    if (polygon_form_factor(a, b) > 0) pairs.push_back({a, b});
  }
  const std::clock_t start = std::clock();
  double sum = 0;
  for (const auto& [a, b] : pairs) sum += polygon_form_factor(a, b);
  const double seconds = double(std::clock() - start) / CLOCKS_PER_SEC;
  EXPECT_GT(sum, 0);
  EXPECT_GT(double(pairs.size()) / seconds, 1000) << "pairs per second";
}

}  // namespace
}  // namespace luxel::viewfactor
