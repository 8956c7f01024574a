#include "luxel/pipeline/settings/sky_setting.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "luxel/base/text_tables.h"
#include "luxel/base/vec_double.h"
#include "luxel/pipeline/settings/comma_list.h"
#include "luxel/scene/solar_position.h"

namespace luxel::pipeline {
namespace {

constexpr double kDegree = kPiDouble / 180;

int days_in(int month, int year) {
  constexpr std::array kDays{31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
  const bool leap = (year % 4 == 0 && year % 100 != 0) || year % 400 == 0;
  return kDays[size_t(month - 1)] + (month == 2 && leap ? 1 : 0);
}

/// Takes `digits` digits off the text, and the character `then` when it is not 0.
std::optional<int> take(std::string_view& text, size_t digits, char then) {
  if (text.size() < digits + (then ? 1 : 0)) return std::nullopt;
  int value = 0;
  for (size_t i = 0; i < digits; ++i) {
    if (text[i] < '0' || text[i] > '9') return std::nullopt;
    value = 10 * value + (text[i] - '0');
  }
  if (then && text[digits] != then) return std::nullopt;
  text.remove_prefix(digits + (then ? 1 : 0));
  return value;
}

/// "+02:00", "-05:30" or "Z", in hours.
std::optional<double> parse_offset(std::string_view text) {
  if (text == "Z") return 0.0;
  if (text.empty() || (text[0] != '+' && text[0] != '-')) return std::nullopt;
  const double sign = text[0] == '-' ? -1 : 1;
  text.remove_prefix(1);
  const auto hours = take(text, 2, ':'), minutes = hours ? take(text, 2, 0) : std::nullopt;
  if (!minutes || !text.empty() || *hours > 14 || *minutes > 59) return std::nullopt;
  return sign * (*hours + *minutes / 60.0);
}

/// YYYY-MM-DDThh:mm[:ss] and an offset.
std::optional<scene::UtcTime> parse_time(std::string_view text) {
  const auto year = take(text, 4, '-');
  const auto month = year ? take(text, 2, '-') : std::nullopt;
  const auto day = month ? take(text, 2, 'T') : std::nullopt;
  const auto hour = day ? take(text, 2, ':') : std::nullopt;
  const auto minute = hour ? take(text, 2, 0) : std::nullopt;
  if (!minute) return std::nullopt;
  int second = 0;
  if (!text.empty() && text[0] == ':') {
    text.remove_prefix(1);
    const auto given = take(text, 2, 0);
    if (!given) return std::nullopt;
    second = *given;
  }
  const auto offset = parse_offset(text);
  if (!offset || *year < 1900 || *year > 2100 || *month < 1 || *month > 12 || *day < 1 ||
      *day > days_in(*month, *year) || *hour > 24 || *minute > 59 || second > 60)
    return std::nullopt;
  return scene::UtcTime{*year, *month, *day, *hour + *minute / 60.0 + second / 3600.0 - *offset};
}

/// All of the words from `first` on as numbers.
std::optional<std::vector<double>> numbers_from(const std::vector<std::string_view>& words,
                                                size_t first) {
  std::vector<double> out;
  for (size_t i = first; i < words.size(); ++i) {
    const Result<double> value = luxel::parse_number(words[i]);
    if (!value) return std::nullopt;
    out.push_back(*value);
  }
  return out;
}

Result<SkySetting> by_time(std::string_view text, const std::vector<std::string_view>& words) {
  const auto time = parse_time(words[0]);
  if (!time)
    return fail(ErrorCode::bad_setting,
                "--sky '{}': '{}' is not a time with its offset from UTC between 1900 and 2100, as "
                "2026-06-21T15:30+02:00 or 2026-06-21T13:30Z",
                text, words[0]);
  const auto v = numbers_from(words, 1);
  if (!v || v->size() < 2 || v->size() > 3 || std::abs((*v)[0]) > 90 || std::abs((*v)[1]) > 180)
    return fail(ErrorCode::bad_setting,
                "--sky '{}' is not TIME,LATITUDE,LONGITUDE[,TURBIDITY]; latitude is -90 to 90, "
                "longitude -180 to 180, as in --sky 2026-06-21T15:30+02:00,48.85,2.35",
                text);
  const scene::SolarPosition sun =
      scene::solar_position(scene::julian_day(*time), (*v)[0] * kDegree, (*v)[1] * kDegree);
  SkySetting out{sun.azimuth_rad / kDegree, sun.elevation_rad / kDegree};
  out.sun_distance_au = sun.distance_au;
  if (v->size() == 3) out.turbidity = (*v)[2];
  return out;
}

Result<SkySetting> by_direction(std::string_view text, const std::vector<std::string_view>& words) {
  const auto v = numbers_from(words, 0);
  if (!v || v->size() < 2 || v->size() > 3 || std::abs((*v)[0]) > 360 || std::abs((*v)[1]) > 90)
    return fail(ErrorCode::bad_setting,
                "--sky '{}' is neither AZIMUTH_DEG,ELEVATION_DEG[,TURBIDITY] nor "
                "TIME,LATITUDE,LONGITUDE[,TURBIDITY]; azimuth is -360 to 360, elevation -90 to 90, "
                "as in --sky 135,45",
                text);
  SkySetting out{(*v)[0], (*v)[1]};
  if (v->size() == 3) out.turbidity = (*v)[2];
  return out;
}

}  // namespace

Result<SkySetting> parse_sky(std::string_view text) {
  const std::vector<std::string_view> words = split_at_commas(text);
  const bool has_time = words[0].find('T') != std::string_view::npos;
  LUXEL_TRY(const SkySetting out, has_time ? by_time(text, words) : by_direction(text, words));
  if (!(out.turbidity >= 1 && out.turbidity <= 10))
    return fail(ErrorCode::bad_setting, "--sky '{}': turbidity {} is outside 1 to 10", text,
                out.turbidity);
  return out;
}

scene::SkyParams sky_params(const SkySetting& s) {
  const double azimuth = s.azimuth_deg * kDegree, elevation = s.elevation_deg * kDegree;
  scene::SkyParams out;
  out.towards_sun = to_float(DVec3{std::sin(azimuth) * std::cos(elevation), std::sin(elevation),
                                   -std::cos(azimuth) * std::cos(elevation)});
  out.turbidity = s.turbidity, out.sun_distance_au = s.sun_distance_au;
  return out;
}

scene::PunctualLight sun_light(Rgb illuminance, Vec3 towards) {
  scene::PunctualLight sun;
  sun.name = "sun", sun.kind = scene::PunctualLight::Kind::directional;
  sun.intensity = illuminance, sun.direction = -towards;
  sun.angular_radius_rad = scene::kSunAngularRadiusRad;
  return sun;
}

void add_sky(const SkySetting& setting, scene::Scene& scene) {
  scene::Sky sky = scene::make_sky(sky_params(setting));
  scene.background = {};
  scene.environment = std::move(sky.radiance);
  if (max_component(sky.sun_illuminance) > 0)
    scene.lights.push_back(sun_light(sky.sun_illuminance, sky.towards_sun));
}

}  // namespace luxel::pipeline
