#include "luxel/scene/atmosphere.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "luxel/base/parallel.h"
#include "luxel/base/warp.h"
#include "luxel/scene/sky.h"

namespace luxel::scene {
namespace {

constexpr int kDepthSteps = 128;                        // of a ray to the top
constexpr int kAgainDirections = 64, kAgainSteps = 20;  // as [Hillaire20, section 5.5]

DVec3 times(DVec3 a, DVec3 b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
DVec3 exp_minus(DVec3 a) { return {std::exp(-a.x), std::exp(-a.y), std::exp(-a.z)}; }
DVec3 mix(DVec3 a, DVec3 b, double t) { return a * (1 - t) + b * t; }

double to_sphere(double radius_km, double cosine, double sphere_km) {
  const double b = radius_km * cosine;
  const double inside = sphere_km * sphere_km - radius_km * radius_km + b * b;
  return -b + std::sqrt(std::max(0.0, inside));
}

/// Distance to the ground; < 0 when the ray passes over it.
double to_ground(const Atmosphere& air, double radius_km, double cosine) {
  const double b = radius_km * cosine;
  const double inside = air.ground_km * air.ground_km - radius_km * radius_km + b * b;
  if (inside < 0 || b >= 0) return -1;
  return std::max(0.0, -b - std::sqrt(inside));
}

/// The table's axes: distances to the top between the shortest and the longest, and to the horizon
/// [Bruneton08, section 4; Hillaire20, section 5.2].
struct TableAxes {
  double horizon_km = 0;  ///< from the top to the ground's horizon
  explicit TableAxes(const Atmosphere& air)
      : horizon_km(std::sqrt(air.top_km * air.top_km - air.ground_km * air.ground_km)) {}
};

double radius_of(const Atmosphere& air, double share) {
  const double rho = share * TableAxes(air).horizon_km;
  return std::sqrt(rho * rho + air.ground_km * air.ground_km);
}

double cosine_of(const Atmosphere& air, double radius, double share) {
  const double h = TableAxes(air).horizon_km;
  const double rho = std::sqrt(std::max(0.0, radius * radius - air.ground_km * air.ground_km));
  const double shortest = air.top_km - radius, d = shortest + share * (rho + h - shortest);
  if (d <= 0) return 1;
  return std::clamp((h * h - rho * rho - d * d) / (2 * radius * d), -1.0, 1.0);
}

DVec3 optical_depth(const Atmosphere& air, double radius, double cosine) {
  const double length = to_sphere(radius, cosine, air.top_km), step = length / kDepthSteps;
  DVec3 sum{};
  for (int i = 0; i < kDepthSteps; ++i) {
    const double t = (i + 0.5) * step;
    const double r = std::sqrt(radius * radius + t * t + 2 * radius * t * cosine);
    sum += medium_at(air, r - air.ground_km).extinction * step;
  }
  return sum;
}

/// Bilinear in a table whose entries lie at the middle of the cells' borders: the first at share 0,
/// the last at 1.
DVec3 look_up(const std::vector<DVec3>& table, int width, int height, double u, double v) {
  const double x = std::clamp(u, 0.0, 1.0) * (width - 1),
               y = std::clamp(v, 0.0, 1.0) * (height - 1);
  const int i = std::min(int(x), width - 2), j = std::min(int(y), height - 2);
  const DVec3* row = &table[size_t(j) * size_t(width) + size_t(i)];
  return mix(mix(row[0], row[1], x - i), mix(row[width], row[width + 1], x - i), y - j);
}

/// The sun's cosine on its axis: finest around the horizon.
double share_of_sun(double cosine) {
  return 0.5 + 0.5 * std::copysign(std::sqrt(std::abs(cosine)), cosine);
}
double sun_of_share(double share) {
  const double s = 2 * share - 1;
  return std::copysign(s * s, s);
}

/// The steps of a ray from `radius` at a cosine with the vertical. They grow along the way, as
/// places near the start show most.
AirRay march(const Atmosphere& air, double radius, double cosine, double length, int steps) {
  AirRay out{radius, {}, {1, 1, 1}};
  DVec3& through = out.through;
  for (int i = 0; i < steps; ++i) {
    const double a = double(i) / steps, b = double(i + 1) / steps;
    const double dt = length * (b * b - a * a), t = 0.5 * length * (b * b + a * a);
    AirStep s;
    s.way = t;
    s.radius =
        std::max(air.ground_km, std::sqrt(radius * radius + t * t + 2 * radius * t * cosine));
    s.medium = medium_at(air, s.radius - air.ground_km);
    const DVec3 left = exp_minus(s.medium.extinction * dt);
    const auto mean = [dt](double kept, double extinction) {
      return extinction * dt > 1e-9 ? (1 - kept) / extinction : dt;
    };
    s.reaches =
        times(through, {mean(left.x, s.medium.extinction.x), mean(left.y, s.medium.extinction.y),
                        mean(left.z, s.medium.extinction.z)});
    out.steps.push_back(s);
    through = times(through, left);
  }
  return out;
}

/// The sun's cosine with the vertical at a step of a ray, whose start it has `at_start`; `angle`:
/// the cosine between ray and sun.
double sun_cosine_at(const AirRay& ray, const AirStep& s, double at_start, double angle) {
  return (ray.radius * at_start + s.way * angle) / s.radius;
}

/// A ray through the air, to its end or to the ground.
struct WayOut {
  double cosine = 0;   ///< with the vertical
  double ground = -1;  ///< the way there; < 0: it passes over it
  AirRay ray;
};
WayOut way_out(const AirTables& t, double radius, double cosine, int steps) {
  const double ground = to_ground(t.air, radius, cosine);
  const double way = ground >= 0 ? ground : to_sphere(radius, cosine, t.air.top_km);
  return {cosine, ground, march(t.air, radius, cosine, way, steps)};
}

/// Rays to all sides on a Fibonacci spiral, from the top down.
std::vector<WayOut> ways_out(const AirTables& t, double radius) {
  std::vector<WayOut> out;
  for (int k = 0; k < kAgainDirections; ++k)
    out.push_back(way_out(t, radius, 1 - 2 * (k + 0.5) / kAgainDirections, kAgainSteps));
  return out;
}

/// [Hillaire20, eqs. 5 to 10] at one place: the second scattering, and all after it as a geometric
/// series.
DVec3 scattered_again_at(const AirTables& t, std::span<const WayOut> ways, double sun_cosine) {
  const double sun_sine = std::sqrt(std::max(0.0, 1 - sun_cosine * sun_cosine));
  DVec3 second{}, share{};
  for (size_t k = 0; k < ways.size(); ++k) {
    const auto& [up, ground, ray] = ways[k];
    const double phi = 2.399963229728653 * double(k);
    const double angle = std::sqrt(1 - up * up) * std::cos(phi) * sun_sine + up * sun_cosine;
    for (const AirStep& s : ray.steps) {
      const DVec3 scattered = times(s.medium.rayleigh + s.medium.aerosol, s.reaches);
      const double cosine = sun_cosine_at(ray, s, sun_cosine, angle);
      second += times(scattered, transmittance_to_sun(t, s.radius, cosine)) * (1 / (4 * kPiDouble));
      share += scattered;
    }
    if (ground < 0) continue;
    const double cosine = (ray.radius * sun_cosine + ground * angle) / t.air.ground_km;
    second += times(ray.through, transmittance_to_sun(t, t.air.ground_km, cosine)) *
              (t.air.ground_albedo / kPiDouble * std::max(0.0, cosine));
  }
  const double each = 1.0 / double(ways.size());
  second = second * each, share = share * each;
  return {second.x / (1 - share.x), second.y / (1 - share.y), second.z / (1 - share.z)};
}

DVec3 scattered_again(const AirTables& t, double radius, double sun_cosine) {
  const double height = (radius - t.air.ground_km) / (t.air.top_km - t.air.ground_km);
  return look_up(t.scattered_again, t.suns, t.radii, share_of_sun(sun_cosine), std::sqrt(height));
}

/// `row_at(v)` makes a row's entries: those at the shares u.
void fill(std::vector<DVec3>& table, int width, int height, const auto& row_at) {
  table.resize(size_t(width) * size_t(height));
  parallel_for(size_t(height), 1, [&](size_t begin, size_t end) {
    for (size_t j = begin; j < end; ++j) {
      const auto entry = row_at(double(j) / (height - 1));
      for (int i = 0; i < width; ++i)
        table[j * size_t(width) + size_t(i)] = entry(double(i) / (width - 1));
    }
  });
}

}  // namespace

Atmosphere atmosphere_of(double turbidity) {
  Atmosphere air;
  constexpr double kAngstrom = 1.3;  // [Preetham99, appendix 1]
  const double green =
      (turbidity - 1) * air.rayleigh_per_km.y * air.rayleigh_height_km / air.aerosol_height_km;
  air.aerosol_per_km =
      DVec3{std::pow(550.0 / 680, kAngstrom), 1, std::pow(550.0 / 440, kAngstrom)} *
      (green * air.aerosol_albedo);
  return air;
}

Medium medium_at(const Atmosphere& air, double altitude_km) {
  Medium m;
  m.rayleigh = air.rayleigh_per_km * std::exp(-altitude_km / air.rayleigh_height_km);
  m.aerosol = air.aerosol_per_km * std::exp(-altitude_km / air.aerosol_height_km);
  const double ozone =
      std::max(0.0, 1 - std::abs(altitude_km - air.ozone_height_km) / air.ozone_reach_km);
  m.extinction = m.rayleigh + m.aerosol * (1 / air.aerosol_albedo) + air.ozone_per_km * ozone;
  return m;
}

double rayleigh_phase(double cosine) { return 3 / (16 * kPiDouble) * (1 + cosine * cosine); }

double aerosol_phase(double g, double cosine) {
  const double k = 3 / (8 * kPiDouble) * (1 - g * g) / (2 + g * g);
  return k * (1 + cosine * cosine) / std::pow(1 + g * g - 2 * g * cosine, 1.5);
}

AirTables make_transmittance(const Atmosphere& air, int heights) {
  AirTables t;
  t.air = air;
  t.width = 256, t.height = heights;
  fill(t.transmittance, t.width, t.height, [&air](double v) {
    return [&air, radius = radius_of(air, v)](double u) {
      return exp_minus(optical_depth(air, radius, cosine_of(air, radius, u)));
    };
  });
  return t;
}

AirTables make_air_tables(const Atmosphere& air) {
  AirTables t = make_transmittance(air, 64);
  t.suns = 65, t.radii = 32;
  fill(t.scattered_again, t.suns, t.radii, [&t](double v) {
    const double radius = t.air.ground_km + v * v * (t.air.top_km - t.air.ground_km);
    return [&t, ways = ways_out(t, radius)](double u) {
      return scattered_again_at(t, ways, sun_of_share(u));
    };
  });
  return t;
}

DVec3 transmittance_to_top(const AirTables& t, double radius_km, double cosine) {
  const double h = TableAxes(t.air).horizon_km;
  const double rho =
      std::sqrt(std::max(0.0, radius_km * radius_km - t.air.ground_km * t.air.ground_km));
  const double d = to_sphere(radius_km, cosine, t.air.top_km), shortest = t.air.top_km - radius_km;
  const double u = (d - shortest) / (rho + h - shortest);
  return look_up(t.transmittance, t.width, t.height, u, rho / h);
}

DVec3 transmittance_to_sun(const AirTables& t, double radius_km, double sun_cosine) {
  const double sine = std::min(1.0, t.air.ground_km / radius_km);
  const double horizon = -std::sqrt(1 - sine * sine);
  // The disc's part above the horizon, smoothly; sine turns angles into cosines there.
  const double half = double(kSunAngularRadiusRad) * sine;
  const double up = std::clamp((sun_cosine - horizon + half) / (2 * half), 0.0, 1.0);
  if (up == 0) return {};
  return transmittance_to_top(t, radius_km, std::max(sun_cosine, horizon)) *
         (up * up * (3 - 2 * up));
}

AirRay sky_ray(const AirTables& t, double eye_km, double cosine, int steps) {
  return way_out(t, eye_km, cosine, steps).ray;
}

SkyLight sky_light(const AirTables& t, const AirRay& ray, double sun_cosine, double angle) {
  SkyLight out{};
  for (const AirStep& s : ray.steps) {
    const double sun = sun_cosine_at(ray, s, sun_cosine, angle);
    const DVec3 once = times(transmittance_to_sun(t, s.radius, sun), s.reaches);
    out.by_air += times(s.medium.rayleigh, once);
    out.by_haze += times(s.medium.aerosol, once);
    const DVec3 again = times(scattered_again(t, s.radius, sun), s.reaches);
    out.again += times(s.medium.rayleigh + s.medium.aerosol, again);
  }
  return out;
}

SkyLight mix(const SkyLight& a, const SkyLight& b, double part) {
  return {mix(a.by_air, b.by_air, part), mix(a.by_haze, b.by_haze, part),
          mix(a.again, b.again, part)};
}

DVec3 sky_radiance(const AirTables& t, const SkyLight& light, double angle) {
  return light.by_air * rayleigh_phase(angle) +
         light.by_haze * aerosol_phase(t.air.aerosol_g, angle) + light.again;
}

}  // namespace luxel::scene
