#include "scene/sky.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "base/parallel.h"
#include "base/vec_double.h"
#include "scene/atmosphere.h"

namespace luxel::scene {
namespace {

constexpr double kEyeKm = 0.002;
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

/// direction_of a pixel's centre, in double.
DVec3 direction_at(const Environment& map, int x, int y) {
  const double theta = kPiDouble * (y + 0.5) / map.height;
  const double phi = 2 * kPiDouble * ((x + 0.5) / map.width - 0.5);
  return {std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi)};
}

/// All of a row look as steeply up: they go through the same air.
void draw_upper_half(const AirTables& t, DVec3 towards_sun, double lux, Environment& map) {
  parallel_for(size_t(map.height / 2), 1, [&](size_t begin, size_t end) {
    for (size_t y = begin; y < end; ++y) {
      const AirRay ray =
          sky_ray(t, t.air.ground_km + kEyeKm, direction_at(map, 0, int(y)).y, kSteps);
      for (size_t x = 0; x < size_t(map.width); ++x) {
        const double angle = dot(direction_at(map, int(x), int(y)), towards_sun);
        map.radiance[y * size_t(map.width) + x] =
            to_float(sky_radiance(t, ray, towards_sun.y, angle) * lux);
      }
    }
  });
}

}  // namespace

Sky make_sky(const SkyParams& params) {
  LUXEL_CHECK(params.height >= 2 && params.height % 2 == 0);
  LUXEL_CHECK(params.turbidity >= 1 && params.sun_distance_au > 0);
  const AirTables tables = make_air_tables(atmosphere_of(params.turbidity));
  const double lux = kSunLux / (params.sun_distance_au * params.sun_distance_au);
  const DVec3 sun = normalize(to_double(params.towards_sun));
  Sky out;
  out.towards_sun = to_float(sun);
  out.sun_illuminance =
      to_float(through_air(tables, std::asin(std::clamp(sun.y, -1.0, 1.0))) * lux);
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
