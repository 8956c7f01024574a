// Form factors past blockers that nearly touch a polygon, against closed forms.
#include <gtest/gtest.h>

#include <algorithm>

#include "luxel/viewfactor/polygon_form_factor.h"
#include "luxel/viewfactor/polygon_test_support.h"
#include "luxel/viewfactor/random_contacts.h"
#include "luxel/viewfactor/visible_form_factor.h"

namespace luxel::viewfactor {
namespace {

/// Facing up, or down when `down`.
Polygon plate(double x0, double y0, double x1, double y1, double z, bool down = false) {
  Polygon p{{x0, y0, z}, {x1, y0, z}, {x1, y1, z}, {x0, y1, z}};
  if (down) std::reverse(p.begin(), p.end());
  return p;
}

// A plate a ten-thousandth above a third of the floor. What is seen jumps along its edge, and
// samples that halve the floor again and again fall on the same side of it each time.
TEST(NearBlockers, APlateCloseToAThirdOfTheFloor) {
  const Polygon floor = plate(0, 0, 1, 1, 0), light = plate(0, 0, 1, 1, 1, true);
  const std::vector<Polygon> third{plate(0, 0, 1.0 / 3, 1, 1e-4)};
  const double h = 1e-4, rim = h / (1 - h);  // how far light from the far end gets under the plate
  const double open = polygon_exchange_area(floor, light).value;
  const double covered = polygon_exchange_area(plate(0, 0, 1.0 / 3, 1, 0), light).value;
  const double dark =
      polygon_exchange_area(plate(rim, rim, 1.0 / 3 - rim, 1 - rim, 0), light).value;
  for (const double tolerance : {1e-3, 1e-4, 1e-5}) {
    const FormFactor f = form_factor(floor, light, third, tolerance);
    EXPECT_LE(f.error, tolerance * f.value);
    EXPECT_GE(f.value, open - covered - f.error);
    EXPECT_LE(f.value, open - dark + f.error);
  }
}

// The estimate takes four standard deviations of errors whose spread it guesses: one in a hundred
// may lie beyond, by no more than as much again.
TEST(NearBlockersSlow, StatedErrorsHoldInRandomContacts) {
  for (const double tolerance : {1e-3, 1e-4}) {
    Dice dice{7, 0};
    const int scenes = 100;
    int beyond = 0, blocked = 0;
    for (int i = 0; i < scenes; ++i) {
      const Contact c = random_contact(dice.seed, dice.index);
      const Motion motion = dice.motion(1);
      std::vector<Blocker> opaque;
      for (const Polygon& s : c.blockers) opaque.push_back(make_blocker(moved(s, motion)));
      const VisibleExchange e = visible_exchange_area(moved(c.a, motion), moved(c.b, motion),
                                                      opaque, {.tolerance = tolerance});
      // Slivers leave 1e-7 of what they exchange themselves.
      const double error = std::abs(e.value - c.exact), rounding = 1e-9 * c.exact;
      EXPECT_FALSE(e.gave_up) << i;
      EXPECT_LE(error, 2 * e.error + rounding) << tolerance << ": scene " << i;
      beyond += error > e.error + rounding;
      blocked += e.cells > 2;
    }
    EXPECT_LE(beyond, 1) << tolerance;
    EXPECT_GE(blocked, scenes / 2) << tolerance;
  }
}

}  // namespace
}  // namespace luxel::viewfactor
