#include "luxel/scene/solar_position.h"

#include <gtest/gtest.h>

#include "luxel/base/vec_double.h"

namespace luxel::scene {
namespace {

constexpr double kSolarDegree = kPiDouble / 180;

SolarPosition at(const UtcTime& time, double latitude_deg, double longitude_deg) {
  return solar_position(julian_day(time), latitude_deg * kSolarDegree,
                        longitude_deg * kSolarDegree);
}

// [Meeus98, chapter 7]: the examples there.
TEST(JulianDay, OfKnownMoments) {
  EXPECT_EQ(julian_day({2000, 1, 1, 12}), 2451545.0);
  EXPECT_EQ(julian_day({1987, 1, 27, 0}), 2446822.5);
  EXPECT_EQ(julian_day({1987, 6, 19, 12}), 2446966.0);
  EXPECT_EQ(julian_day({1900, 1, 1, 0}), 2415020.5);
  EXPECT_NEAR(julian_day({1957, 10, 4, 0.81 * 24}), 2436116.31, 1e-8);
}

// [Reda04, table A5.1]: 17 October 2003, 12:30:30 at UTC - 7 h, 39.742476 N, 105.1786 W: elevation
// without refraction 39.872046, azimuth 194.340241 degrees. The claim of 0.01 degrees, twice.
TEST(SolarPosition, TheExampleOfTheSolarPositionAlgorithm) {
  const SolarPosition sun = at({2003, 10, 17, 19 + 30.5 / 60}, 39.742476, -105.1786);
  EXPECT_NEAR(sun.elevation_rad / kSolarDegree, 39.872046, 0.02);
  EXPECT_NEAR(sun.azimuth_rad / kSolarDegree, 194.340241, 0.02);
}

// From the pole the sun's elevation is its declination. [Meeus98, example 25.a]: 13 October 1992,
// 0 h: -7.78507 degrees, 0.99766 au.
TEST(SolarPosition, TheExampleOfMeeus) {
  const SolarPosition sun = at({1992, 10, 13, 0}, 90, 0);
  EXPECT_NEAR(sun.elevation_rad / kSolarDegree, -7.78507, 0.01);
  EXPECT_NEAR(sun.distance_au, 0.99766, 1e-5);
}

// The beginnings of the seasons and the earth's nearest and farthest days of 2026, by the
// almanac: equinoxes 20 March 14:46 and 23 September 00:05, solstices 21 June 08:24 and 21 December
// 20:50, perihelion 3 January (0.98330 au), aphelion 6 July (1.01664 au).
// Moon and planets, which are left out, move the earth by up to 1e-4 au.
TEST(SolarPosition, TheSeasonsOf2026) {
  const auto declination = [](const UtcTime& time) {
    return at(time, 90, 0).elevation_rad / kSolarDegree;
  };
  EXPECT_NEAR(declination({2026, 3, 20, 14 + 46 / 60.0}), 0, 0.01);
  EXPECT_NEAR(declination({2026, 9, 23, 5 / 60.0}), 0, 0.01);
  EXPECT_NEAR(declination({2026, 6, 21, 8 + 24 / 60.0}), 23.436, 0.01);
  EXPECT_NEAR(declination({2026, 12, 21, 20 + 50 / 60.0}), -23.436, 0.01);
  EXPECT_NEAR(at({2026, 1, 3, 17}, 0, 0).distance_au, 0.98330, 1e-4);
  EXPECT_NEAR(at({2026, 7, 6, 17}, 0, 0).distance_au, 1.01664, 1e-4);
}

// The equation of time by the almanac: the sun is in the south at 12:14:12 UTC on 11 February 2026
// and at 11:43:34 on 3 November at Greenwich, within a few seconds (0.1 degrees are 24 s).
TEST(SolarPosition, NoonFollowsTheEquationOfTime) {
  EXPECT_NEAR(at({2026, 2, 11, 12 + 14.2 / 60}, 51.48, 0).azimuth_rad / kSolarDegree, 180, 0.1);
  EXPECT_NEAR(at({2026, 11, 3, 11 + 43.57 / 60}, 51.48, 0).azimuth_rad / kSolarDegree, 180, 0.1);
}

// In the morning it stands in the east, everywhere between the tropics and the poles.
TEST(SolarPosition, RisesInTheEast) {
  for (const double latitude : {-50.0, 30.0, 60.0}) {
    const SolarPosition morning = at({2026, 3, 20, 7}, latitude, 0);
    const SolarPosition evening = at({2026, 3, 20, 17}, latitude, 0);
    EXPECT_NEAR(morning.azimuth_rad, kPiDouble / 2, 0.4);
    EXPECT_NEAR(evening.azimuth_rad, 3 * kPiDouble / 2, 0.4);
    EXPECT_GT(morning.elevation_rad, 0);
  }
}

}  // namespace
}  // namespace luxel::scene
