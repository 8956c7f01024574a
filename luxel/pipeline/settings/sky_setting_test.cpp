#include "luxel/pipeline/settings/sky_setting.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "luxel/pipeline/settings/settings.h"

namespace luxel::pipeline {
namespace {

using ::testing::HasSubstr;

std::string sky_error(const std::string& text) {
  const auto sky = parse_sky(text);
  if (sky) return "no error";
  EXPECT_THAT(sky.error().message, HasSubstr("--sky '" + text + "'"));
  EXPECT_EQ(sky.error().code, ErrorCode::bad_setting);
  return sky.error().message;
}

TEST(SkySetting, ByDirection) {
  const auto sky = parse_sky("135,45");
  ASSERT_TRUE(sky);
  EXPECT_EQ(sky->azimuth_deg, 135);
  EXPECT_EQ(sky->elevation_deg, 45);
  EXPECT_EQ(sky->turbidity, 2);
  EXPECT_EQ(sky->sun_distance_au, 1);
  EXPECT_EQ(parse_sky("-10.5,-3,4.5")->turbidity, 4.5);
}

// 17 October 2003 in Golden, Colorado [Reda04, table A5.1], told in three time zones.
TEST(SkySetting, ByTimeAndPlace) {
  for (const char* time :
       {"2003-10-17T12:30:30-07:00", "2003-10-17T19:30:30Z", "2003-10-18T01:00:30+05:30"}) {
    const auto sky = parse_sky(std::string(time) + ",39.742476,-105.1786");
    ASSERT_TRUE(sky) << time;
    EXPECT_NEAR(sky->azimuth_deg, 194.340, 0.02) << time;
    EXPECT_NEAR(sky->elevation_deg, 39.872, 0.02) << time;
    EXPECT_NEAR(sky->sun_distance_au, 0.9965, 5e-4) << time;
    EXPECT_EQ(sky->turbidity, 2);
  }
  EXPECT_EQ(parse_sky("2026-06-21T15:30+02:00,48.85,2.35,3")->turbidity, 3);
  EXPECT_TRUE(parse_sky("2024-02-29T00:00Z,0,0"));
}

TEST(SkySetting, WhatIsNoneIsSaid) {
  for (const char* text : {"", "1", "1,2,3,4", "a,b", "135,91", "400,10", "135,45,", "nan,3"})
    EXPECT_THAT(sky_error(text), HasSubstr("AZIMUTH_DEG,ELEVATION_DEG")) << text;
  for (const char* text : {"135,45,0.5", "135,45,11"})
    EXPECT_THAT(sky_error(text), HasSubstr("outside 1 to 10")) << text;
  for (const char* text :
       {"2026-06-21T15:30,48,2", "2026-6-21T15:30Z,48,2", "2026-02-29T15:30Z,48,2",
        "2026-13-01T15:30Z,48,2", "2026-06-21T25:30Z,48,2", "1826-06-21T15:30Z,48,2",
        "2026-06-21T15:30+0200,48,2", "T,48,2", "2026-06-21T15:30:7Z,48,2"})
    EXPECT_THAT(sky_error(text), HasSubstr("is not a time with its offset")) << text;
  for (const char* text : {"2026-06-21T15:30Z", "2026-06-21T15:30Z,48", "2026-06-21T15:30Z,98,2",
                           "2026-06-21T15:30Z,48,200", "2026-06-21T15:30Z,48,2,3,4"})
    EXPECT_THAT(sky_error(text), HasSubstr("LATITUDE,LONGITUDE")) << text;
}

// The compass as --sun has it.
TEST(SkySetting, TheSunStandsWhereSunHasIt) {
  for (const auto& [azimuth, elevation] : {std::pair{0.0, 10.0}, {90.0, 30.0}, {200.0, 60.0}}) {
    const Vec3 a = sky_params({azimuth, elevation}).towards_sun;
    const Vec3 b = -sun_light({float(azimuth), float(elevation), 1}).direction;
    EXPECT_NEAR(length(a - b), 0, 1e-6f) << azimuth;
  }
  EXPECT_NEAR(sky_params({90, 0}).towards_sun.x, 1, 1e-6f);
}

TEST(SkySetting, TheSunIsALampWhileItIsUp) {
  scene::Scene day, night;
  add_sky({90, 40}, day);
  ASSERT_EQ(day.lights.size(), 1u);
  EXPECT_EQ(day.lights[0].kind, scene::PunctualLight::Kind::directional);
  EXPECT_EQ(day.lights[0].angular_radius_rad, scene::kSunAngularRadiusRad);
  EXPECT_LT(day.lights[0].direction.x, -0.7f);
  // [IES84] at 40 degrees: 92 klx on a facing surface; see luxel/scene/sky_test.cpp.
  EXPECT_NEAR(luminance(day.lights[0].intensity), 92e3f, 9e3f);
  add_sky({90, -4}, night);
  EXPECT_TRUE(night.lights.empty());
}

}  // namespace
}  // namespace luxel::pipeline
