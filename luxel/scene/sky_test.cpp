#include "luxel/scene/sky.h"

#include <gtest/gtest.h>

#include "luxel/base/parallel.h"
#include "luxel/base/vec_double.h"
#include "luxel/scene/atmosphere.h"
#include "luxel/scene/sun_illuminance.h"

namespace luxel::scene {
namespace {

Vec3 sun_at(double azimuth_deg, double elevation_deg) {
  const double a = azimuth_deg * kPiDouble / 180, e = elevation_deg * kPiDouble / 180;
  return to_float(DVec3{std::sin(a) * std::cos(e), std::sin(e), -std::cos(a) * std::cos(e)});
}

Sky sky_at(double elevation_deg, double turbidity = 2, double azimuth_deg = 0, int height = 32) {
  return make_sky({sun_at(azimuth_deg, elevation_deg), turbidity, 1, height});
}

double lux_of(const Sky& sky) { return double(luminance(horizontal_irradiance(sky.radiance))); }

Rgb pixel(const Sky& sky, int x, int y) {
  return sky.radiance.radiance[size_t(y) * size_t(sky.radiance.width) + size_t(x)];
}

bool is_light(const Sky& sky) {
  for (const Rgb& l : sky.radiance.radiance)
    for (const float v : {l.x, l.y, l.z})
      if (!std::isfinite(v) || v < 0) return false;
  return true;
}

// [IES84]: the sun on a facing surface 127.5 exp(-0.21 / sin h) klx, clear skies on the horizontal
// 0.8 + 15.5 sqrt(sin h) klx: means of measurements, single days of which differ by half and more.
// Turbidity 2 is Preetham's very clear sky: the sun within a tenth; the sky, which haze changes
// most, within 30 %.
TEST(SkySlow, IsAsBrightAsMeasuredClearSkies) {
  for (const double elevation : {30.0, 45.0, 60.0, 75.0}) {
    const double sine = std::sin(elevation * kPiDouble / 180);
    const double sun = 127500 * std::exp(-0.21 / sine), diffuse = 800 + 15500 * std::sqrt(sine);
    const Sky sky = sky_at(elevation);
    EXPECT_NEAR(double(luminance(sky.sun_illuminance)), sun, 0.1 * sun) << elevation;
    EXPECT_NEAR(lux_of(sky), diffuse, 0.3 * diffuse) << elevation;
  }
}

// [AMS24]: on the horizontal under clear skies 410 to 585 lx with the sun's centre at 0 degrees, 2
// to 3.5 lx at -6, about 0.008 lx at -12. Within a factor of two: light there has been scattered
// high up and several times, which [Hillaire20] approximates, and evenings differ.
TEST(SkySlow, TwilightIsAboutAsDarkAsMeasured) {
  struct Measured {
    double elevation_deg, low_lux, high_lux;
  };
  for (const Measured& m : {Measured{0, 410, 585}, {-6, 2, 3.5}, {-12, 0.008, 0.008}}) {
    const double lux = lux_of(sky_at(m.elevation_deg));
    EXPECT_GT(lux, m.low_lux / 2) << m.elevation_deg;
    EXPECT_LT(lux, m.high_lux * 2) << m.elevation_deg;
  }
}

TEST(SkySlow, FallsSteadilyThroughTwilightAndStaysFinite) {
  double before = INFINITY;
  for (const double elevation : {20.0, 5.0, 1.0, 0.2, 0.0, -0.2, -1.0, -3.0, -6.0, -9.0, -18.0}) {
    const Sky sky = sky_at(elevation);
    ASSERT_TRUE(is_light(sky)) << elevation;
    EXPECT_LT(lux_of(sky), before) << elevation;
    before = lux_of(sky);
  }
  // The sun sets as its disc does, 0.27 degrees above and below its centre.
  EXPECT_GT(luminance(sky_at(0).sun_illuminance), 0);
  EXPECT_EQ(luminance(sky_at(-0.3).sun_illuminance), 0);
  ASSERT_TRUE(is_light(sky_at(-90)));
}

// At -30 degrees the earth's shadow reaches 980 km up, over all of the air, even the clearest. What
// is left comes out of the table of light scattered again, whose entries are 3 degrees apart.
TEST(Sky, NightIsBlack) { EXPECT_LT(lux_of(sky_at(-30, 1)), 1e-9); }

// North (-Z) is the column at u = 0.25: the picture is the same to both sides of it. East (+X) is
// at 0.5: turning the sun there turns the picture by a quarter.
TEST(Sky, IsSymmetricAboutTheSunAndTurnsWithIt) {
  const Sky north = sky_at(25), east = sky_at(25, 2, 90);
  const int width = north.radiance.width, quarter = width / 4;
  for (int y = 0; y < north.radiance.height; ++y)
    for (int x = 0; x < width; ++x) {
      const Rgb here = pixel(north, x, y);
      const Rgb there = pixel(north, (2 * quarter - 1 - x + width) % width, y);
      const Rgb turned = pixel(east, (x + quarter) % width, y);
      // The sun's direction is of floats.
      EXPECT_NEAR(luminance(here), luminance(there), 1e-4f * luminance(here)) << x << " " << y;
      EXPECT_NEAR(luminance(here), luminance(turned), 1e-4f * luminance(here)) << x << " " << y;
    }
}

// Each pixel against its own way through the air: between the azimuths that are worked out light is
// interpolated. After sunset the earth's shadow crosses the sky.
TEST(SkySlow, IsTheLightOfEachPixelsOwnDirection) {
  const AirTables air = make_air_tables(atmosphere_of(2));
  for (const auto& [elevation_deg, tolerance] : {std::pair{60.0, 1e-4},
                                                 {20.0, 1e-4},
                                                 {3.0, 1e-3},
                                                 {-3.0, 3e-3},
                                                 {-6.0, 3e-3},
                                                 {-12.0, 1e-2}}) {
    const Sky sky = sky_at(elevation_deg, 2, 77, 32);
    const DVec3 sun = to_double(sun_at(77, elevation_deg));
    for (int y = 0; y < 16; ++y) {
      const Vec3 up = direction_of(sky.radiance, {0, (float(y) + 0.5f) / 32});
      const AirRay ray = sky_ray(air, air.air.ground_km + 0.002, double(up.y), 96);
      for (int x = 0; x < 64; ++x) {
        const Vec2 at{(float(x) + 0.5f) / 64, (float(y) + 0.5f) / 32};
        const double angle = dot(to_double(direction_of(sky.radiance, at)), sun);
        const DVec3 l = sky_radiance(air, sky_light(air, ray, sun.y, angle), angle) * kSunLux;
        const double expected = double(luminance(to_float(l)));
        EXPECT_NEAR(double(luminance(pixel(sky, x, y))), expected, tolerance * expected)
            << elevation_deg << " " << x << " " << y;
      }
    }
  }
}

TEST(SkySlow, IsBrightestAroundTheSun) {
  const Sky sky = sky_at(30, 2, 90, 64);  // +X, u = 0.5; 60 degrees from the top
  int best_x = 0, best_y = 0;
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 128; ++x)
      if (luminance(pixel(sky, x, y)) > luminance(pixel(sky, best_x, best_y)))
        best_x = x, best_y = y;
  EXPECT_NEAR(best_x + 0.5, 64, 1.01);
  EXPECT_NEAR(best_y + 0.5, 64 * 60 / 180.0, 1.01);
}

// At noon the zenith is darker and bluer than the horizon away from the sun.
TEST(Sky, TheZenithIsDarkerAndBluerThanTheHorizon) {
  const Sky sky = sky_at(45);
  const int away = 3 * sky.radiance.width / 4;  // the sun stands in the north
  const Rgb zenith = pixel(sky, away, 0);
  const Rgb horizon = pixel(sky, away, sky.radiance.height / 2 - 1);
  EXPECT_LT(luminance(zenith), 0.6f * luminance(horizon));
  EXPECT_GT(zenith.z / zenith.x, 1.5f * horizon.z / horizon.x);
  EXPECT_GT(zenith.z, zenith.y);
  EXPECT_GT(zenith.y, zenith.x);
}

TEST(SkySlow, TheLowSunIsWeakerAndRedder) {
  float light = INFINITY, blue_over_red = INFINITY;
  for (const double elevation : {90.0, 45.0, 20.0, 10.0, 5.0, 2.0, 1.0}) {
    const Rgb sun = sky_at(elevation).sun_illuminance;
    EXPECT_LT(luminance(sun), light) << elevation;
    EXPECT_LT(sun.z / sun.x, blue_over_red) << elevation;
    light = luminance(sun), blue_over_red = sun.z / sun.x;
  }
}

TEST(SkySlow, HazeTakesFromTheSunAndGivesToTheSky) {
  double sun = INFINITY, sky = 0;
  for (const double turbidity : {1.0, 2.0, 4.0}) {
    const Sky s = sky_at(50, turbidity);
    EXPECT_LT(double(luminance(s.sun_illuminance)), sun);
    EXPECT_GT(lux_of(s), sky);
    sun = double(luminance(s.sun_illuminance)), sky = lux_of(s);
  }
}

TEST(Sky, TheSunIsKnownWithoutItsPicture) {
  for (const float up : {-0.1f, 0.002f, 0.1f, 0.7f, 1.0f}) {
    SkyParams params;
    params.towards_sun = normalize(Vec3{std::sqrt(1 - up * up), up, 0});
    params.turbidity = 3, params.sun_distance_au = 1.01, params.height = 2;
    EXPECT_EQ(sun_illuminance(params), make_sky(params).sun_illuminance) << up;
  }
}

TEST(Sky, GrowsWithTheNearnessOfTheSun) {
  const Sky far = make_sky({sun_at(0, 40), 2, 1, 16}), near = make_sky({sun_at(0, 40), 2, 0.5, 16});
  EXPECT_NEAR(lux_of(near), 4 * lux_of(far), 1e-4 * lux_of(near));
  EXPECT_NEAR(luminance(near.sun_illuminance), 4 * luminance(far.sun_illuminance), 1);
}

// The ground: albedo / pi of what lands on it, the same in all directions.
TEST(Sky, BelowTheHorizonIsLitGround) {
  const Sky sky = sky_at(35);
  const Rgb onto =
      horizontal_irradiance(sky.radiance) + sky.sun_illuminance * std::sin(35 * kPi / 180);
  for (const auto& [x, y] : {std::pair{0, 16}, {40, 20}, {63, 31}}) {
    EXPECT_NEAR(pixel(sky, x, y).x, 0.3f / kPi * onto.x, 1e-4f * onto.x);
    EXPECT_NEAR(pixel(sky, x, y).z, 0.3f / kPi * onto.z, 1e-4f * onto.z);
  }
}

// An even picture of radiance 1 brings pi; one that is lit up to 30 degrees from the top
// pi sin^2(30) = pi / 4.
TEST(Sky, HorizontalIlluminanceOfKnownPictures) {
  const Environment even{24, 12, std::vector<Rgb>(24 * 12, Rgb{1, 1, 1}), 0};
  Environment cap{24, 12, std::vector<Rgb>(24 * 12), 0};
  std::fill_n(cap.radiance.begin(), 2 * 24, Rgb{1, 1, 1});
  EXPECT_NEAR(horizontal_irradiance(even).x, kPi, 1e-5f);
  EXPECT_NEAR(horizontal_irradiance(cap).y, kPi / 4, 1e-5f);
}

TEST(Sky, HasTheSameBitsForAnyNumberOfThreads) {
  std::vector<Rgb> first;
  for (const int threads : {1, 3}) {
    const ThreadLimit limit(threads);
    const Sky sky = sky_at(12, 3, 77, 16);
    if (first.empty()) first = sky.radiance.radiance;
    EXPECT_EQ(first, sky.radiance.radiance);
  }
}

}  // namespace
}  // namespace luxel::scene
