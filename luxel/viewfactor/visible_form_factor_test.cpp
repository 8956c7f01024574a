#include "luxel/viewfactor/visible_form_factor.h"

#include <gtest/gtest.h>

#include "luxel/viewfactor/point_form_factor.h"
#include "luxel/viewfactor/polygon_test_support.h"
#include "luxel/viewfactor/sampled_factors.h"
#include "tests/reference_data.h"

namespace luxel::viewfactor {
namespace {

namespace shared = luxel::testing_support;

TEST(VisibleFormFactor, MatchesTheExactTable) {
  int checked = 0;
  for (const auto& row : shared::csv_rows("reference/view-factors.csv")) {
    if (row[1] != "poly" || row[4].empty()) continue;
    const Polygon a = shared::parse_polygon(row[2]), b = shared::parse_polygon(row[3]);
    const double exact = std::stod(row[5]);
    for (const double tolerance : {1e-3, 1e-4, 1e-5}) {
      const FormFactor factor = form_factor(a, b, shared::parse_polygons(row[4]), tolerance);
      // 0 is exactly 0.
      EXPECT_NEAR(factor.value, exact, tolerance * exact) << row[0];
      EXPECT_LE(factor.error, tolerance * exact) << row[0];
    }
    ++checked;
  }
  EXPECT_GE(checked, 5);
}

const Polygon kLowerSquare{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
const Polygon kUpperSquare{{0, 1, 1}, {1, 1, 1}, {1, 0, 1}, {0, 0, 1}};

Polygon horizontal(double x0, double y0, double x1, double y1, double z) {
  return {{x0, y0, z}, {x1, y0, z}, {x1, y1, z}, {x0, y1, z}};
}

TEST(VisibleFormFactor, ManyBlockersThatHideAllLeaveExactlyNothing) {
  std::vector<Polygon> tiles;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      tiles.push_back(horizontal(i / 3.0, j / 3.0, (i + 1) / 3.0, (j + 1) / 3.0, 0.5));
  const FormFactor factor = form_factor(kLowerSquare, kUpperSquare, tiles, 1e-4);
  EXPECT_EQ(factor.value, 0.0);
  Dice dice;
  for (int k = 0; k < 5; ++k) {  // and in any position
    const Motion motion = dice.motion(1);
    std::vector<Polygon> moved_tiles;
    for (const Polygon& tile : tiles) moved_tiles.push_back(moved(tile, motion));
    EXPECT_NEAR(
        form_factor(moved(kLowerSquare, motion), moved(kUpperSquare, motion), moved_tiles, 1e-4)
            .value,
        0.0, 1e-12);
  }
}

TEST(VisibleFormFactor, BlockersBesideTheShaftChangeNoBit) {
  const double alone = form_factor(kLowerSquare, kUpperSquare).value;
  const std::vector<Polygon> beside{
      {{0, 0, 0}, {0, 0, 1}, {0, 1, 1}, {0, 1, 0}},  // a wall of the same room
      horizontal(0, 0, 1, 1, 0),                     // in the plane of the floor
      horizontal(0, 0, 1, 1, 1.5),                   // above the ceiling
      {{2, 0, 0}, {2, 1, 0}, {2, 1, 1}},
      {{0.5, 0.5, 0.5}, {0.5, 0.5, 0.5}, {0.6, 0.6, 0.6}}};  // without area
  EXPECT_EQ(form_factor(kLowerSquare, kUpperSquare, beside).value, alone);
}

// A hole in the light, cut into more pieces or turned over, is the same hole.
TEST(VisibleFormFactor, DoesNotDependOnHowBlockersAreCut) {
  const Polygon whole = horizontal(0.3, 0.2, 0.9, 0.7, 0.4);
  Polygon turned = whole;
  std::reverse(turned.begin(), turned.end());
  const std::vector<std::vector<Polygon>> cuts{
      {whole},
      {turned},
      {whole, whole},
      {horizontal(0.3, 0.2, 0.5, 0.7, 0.4), horizontal(0.5, 0.2, 0.9, 0.7, 0.4)},
      {{whole[0], whole[1], whole[2]}, {whole[0], whole[2], whole[3]}}};
  const double first = form_factor(kLowerSquare, kUpperSquare, cuts[0], 1e-6).value;
  for (const std::vector<Polygon>& cut : cuts)
    EXPECT_NEAR(form_factor(kLowerSquare, kUpperSquare, cut, 1e-5).value, first, 1e-5 * first);
}

// A small thing close to the floor shades a spot that few samples would see.
TEST(VisibleFormFactor, SmallBlockersAreNotOverlooked) {
  const double open = form_factor(kLowerSquare, kUpperSquare).value;
  for (const double x : {0.13, 0.41, 0.77}) {
    const std::vector<Polygon> coin{horizontal(x, 0.31, x + 0.02, 0.33, 0.01)};
    const double blocked = form_factor(kLowerSquare, kUpperSquare, coin, 1e-6).value;
    // The coin hides as much of the ceiling as it sees: all lines through it reach the floor.
    const double hidden = area_m2(coin[0]) * form_factor(coin[0], kUpperSquare).value;
    EXPECT_NEAR(open - blocked, hidden, 1e-5 * open) << x;
  }
}

// A blocker that stands on the floor makes the visible part of the ceiling jump along its foot.
TEST(VisibleFormFactor, ThinWallOnTheFloorHidesByTheSumRule) {
  // Floor and ceiling of two rooms that a wall parts: by symmetry twice the factor of one half.
  const Polygon half_floor = horizontal(0, 0, 0.5, 1, 0);
  const Polygon half_ceiling{{0, 1, 1}, {0.5, 1, 1}, {0.5, 0, 1}, {0, 0, 1}};
  const std::vector<Polygon> wall{{{0.5, 0, 0}, {0.5, 1, 0}, {0.5, 1, 1}, {0.5, 0, 1}}};
  const double half = form_factor(half_floor, half_ceiling).value;
  EXPECT_NEAR(form_factor(kLowerSquare, kUpperSquare, wall, 1e-5).value, half, 1e-5 * half);
}

// Rays know nothing of clipping and cells.
TEST(VisibleFormFactorSlow, AgreesWithRaysAndIsReciprocal) {
  Dice dice;
  int partly = 0;
  for (int i = 0; i < 60; ++i) {
    const Polygon a = dice.rectangle(dice.point(), 1);
    const Polygon b = dice.rectangle(dice.point() + DVec3{2, 0, 0}, 1);
    std::vector<Polygon> blockers;
    for (int k = 0; k < 1 + i % 6; ++k)
      blockers.push_back(dice.rectangle(dice.point() * 0.7 + DVec3{1, 0, 0}, 0.8));
    const double open = polygon_form_factor(a, b);
    if (open < 1e-3) continue;
    const FormFactor factor = form_factor(a, b, blockers, 1e-4);
    EXPECT_LE(factor.error, 1e-4 * factor.value + 1e-8 * open);
    const double back = form_factor(b, a, blockers, 1e-4).value * area_m2(b) / area_m2(a);
    EXPECT_NEAR(factor.value, back, 2e-4 * factor.value + 1e-7 * open) << i;
    const auto rays = sampled_form_factor(a, b, blockers, {.samples = 1u << 18});
    ASSERT_TRUE(rays.has_value());
    EXPECT_NEAR(rays->value, factor.value, 4 * rays->error + 1e-5) << i;
    partly += factor.value > 0 && factor.value < 0.99 * open;
  }
  EXPECT_GE(partly, 5);
}

// Half way up to a ceiling stands a screen whose edge is x = 0: from a floor point at x = d the
// ceiling is seen from x = -d on. Shadows that are kept are those of the point that looks.
TEST(VisiblePointFactor, KeptShadowsMoveWithThePoint) {
  const auto ceiling_from = [](double x) {
    return Polygon{{x, -1, 2}, {x, 1, 2}, {1, 1, 2}, {1, -1, 2}};
  };
  const std::vector<Blocker> screen{
      make_blocker(Polygon{{-9, -9, 1}, {0, -9, 1}, {0, 9, 1}, {-9, 9, 1}})};
  const std::vector<uint32_t> first{0};
  const DVec3 up{0, 0, 1};
  std::vector<uint8_t> casts(1);
  for (const bool keeps : {true, false}) {
    VisibilityScratch scratch;
    scratch.keeps_shadows = keeps;
    for (const double d : {0.0, 0.5, 0.5, -0.25}) {
      const DVec3 point{d, 0, 0};
      const SeenFactor seen =
          visible_point_factor(point, up, ceiling_from(-1), {screen, first}, 1e-12, casts, scratch);
      EXPECT_NEAR(seen.whole, point_to_polygon(point, up, ceiling_from(-1)), 1e-14) << d;
      EXPECT_NEAR(seen.visible, point_to_polygon(point, up, ceiling_from(-d)), 1e-12) << d;
      EXPECT_LT(seen.visible, 0.9 * seen.whole) << d;
    }
  }
}

}  // namespace
}  // namespace luxel::viewfactor
