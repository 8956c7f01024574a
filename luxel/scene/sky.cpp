#include "luxel/scene/sky.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "luxel/base/check.h"
#include "luxel/base/parallel.h"
#include "luxel/base/vec_double.h"
#include "luxel/scene/atmosphere.h"
#include "luxel/scene/sun_illuminance.h"

namespace luxel::scene {
namespace {

constexpr double kEyeKm = 0.002;  // above the ground
/// Steps of a ray through the air. Against 4,000 steps the radiance is off by 0.3 % at most in
/// clear air (turbidity 2) and by 0.7 % in haze (6), most at the horizon; the error falls with
/// their square.
constexpr int kSteps = 96;

/// The mean over the sun's disc of what the air lets through, in horizontal strips: none of those
/// below the horizon.
DVec3 through_air(const AirTables& t, double elevation_rad) {
  constexpr int kStrips = 32;
  DVec3 sum{};
  double weights = 0;
  for (int k = 0; k < kStrips; ++k) {
    const double y = 2 * (k + 0.5) / kStrips - 1, weight = std::sqrt(1 - y * y);
    const double strip = elevation_rad + y * double(kSunAngularRadiusRad);
    weights += weight;
    if (strip > 0) sum += transmittance_to_top(t, t.air.ground_km, std::sin(strip)) * weight;
  }
  return sum * (1 / weights);
}

/// Light of one height above the horizon, at kAzimuths + 1 azimuths from the sun's to the opposite.
/// In between it is interpolated, which is right to 0.01 % by day and to 1 % at the end of
/// twilight: but for the phase functions it is smooth.
constexpr int kAzimuths = 64;
using RowLight = std::array<SkyLight, kAzimuths + 1>;

/// The cosine of the angle between the sun and a direction with the cosine `up` with the vertical.
double angle_to_sun(DVec3 towards_sun, double up, double azimuth_rad) {
  const double sines = std::sqrt((1 - up * up) * std::max(0.0, 1 - towards_sun.y * towards_sun.y));
  return sines * std::cos(azimuth_rad) + up * towards_sun.y;
}

RowLight row_light(const AirTables& t, DVec3 towards_sun, double up) {
  const AirRay ray = sky_ray(t, t.air.ground_km + kEyeKm, up, kSteps);
  RowLight out;
  for (size_t k = 0; k < out.size(); ++k)
    out[k] = sky_light(t, ray, towards_sun.y,
                       angle_to_sun(towards_sun, up, kPiDouble * double(k) / kAzimuths));
  return out;
}

/// `azimuth_rad`: from the sun's, in [0, pi].
SkyLight light_at(const RowLight& row, double azimuth_rad) {
  const double at = azimuth_rad / kPiDouble * kAzimuths;
  const size_t k = std::min(size_t(at), size_t(kAzimuths) - 1);
  return mix(row[k], row[k + 1], at - double(k));
}

/// All of a row look as steeply up: they go through the same air.
void draw_upper_half(const AirTables& t, DVec3 towards_sun, double lux, Environment& map) {
  const double sun_azimuth = std::atan2(towards_sun.z, towards_sun.x);
  parallel_for(size_t(map.height / 2), 1, [&](size_t begin, size_t end) {
    for (size_t y = begin; y < end; ++y) {
      const double up = std::cos(kPiDouble * (double(y) + 0.5) / map.height);
      const RowLight row = row_light(t, towards_sun, up);
      for (size_t x = 0; x < size_t(map.width); ++x) {
        const double phi = 2 * kPiDouble * ((double(x) + 0.5) / map.width - 0.5);
        const double azimuth = std::abs(std::remainder(phi - sun_azimuth, 2 * kPiDouble));
        const double angle = angle_to_sun(towards_sun, up, azimuth);
        map.radiance[y * size_t(map.width) + x] =
            to_float(sky_radiance(t, light_at(row, azimuth), angle) * lux);
      }
    }
  });
}

double lux_above_air(const SkyParams& params) {
  return kSunLux / (params.sun_distance_au * params.sun_distance_au);
}

/// Needs no more than the transmittance from the ground.
Rgb sun_light(const AirTables& tables, const SkyParams& params) {
  const double up = normalize(to_double(params.towards_sun)).y;
  return to_float(through_air(tables, std::asin(std::clamp(up, -1.0, 1.0))) *
                  lux_above_air(params));
}

}  // namespace

Rgb sun_illuminance(const SkyParams& params) {
  return sun_light(make_transmittance(atmosphere_of(params.turbidity), 2), params);
}

Sky make_sky(const SkyParams& params) {
  LUXEL_CHECK(params.height >= 2 && params.height % 2 == 0);
  LUXEL_CHECK(params.turbidity >= 1 && params.sun_distance_au > 0);
  const AirTables tables = make_air_tables(atmosphere_of(params.turbidity));
  const double lux = lux_above_air(params);
  const DVec3 sun = normalize(to_double(params.towards_sun));
  Sky out;
  out.towards_sun = to_float(sun);
  out.sun_illuminance = sun_light(tables, params);
  const size_t width = 2 * size_t(params.height), half = width * size_t(params.height / 2);
  out.radiance = {int(width), params.height, std::vector<Rgb>(2 * half), 0};
  draw_upper_half(tables, sun, lux, out.radiance);
  const Rgb onto_ground =
      horizontal_irradiance(out.radiance) + out.sun_illuminance * float(std::max(0.0, sun.y));
  std::fill(out.radiance.radiance.begin() + std::ptrdiff_t(half), out.radiance.radiance.end(),
            onto_ground * float(tables.air.ground_albedo / kPiDouble));
  return out;
}

}  // namespace luxel::scene
