#include "luxel/scene/atmosphere.h"

#include <gtest/gtest.h>

#include <cmath>

namespace luxel::scene {
namespace {

/// The integral over the sphere of a function of the cosine, by 20000 midpoints.
template <class F>
double over_sphere(const F& f) {
  constexpr int kSteps = 20000;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) sum += f(-1 + 2 * (i + 0.5) / kSteps);
  return sum * 2 / kSteps * 2 * kPiDouble;
}

// Scattered light goes somewhere: phase functions lose none.
TEST(Atmosphere, PhaseFunctionsIntegrateToOne) {
  EXPECT_NEAR(over_sphere(rayleigh_phase), 1, 1e-6);
  for (const double g : {0.0, 0.5, 0.8})
    EXPECT_NEAR(over_sphere([g](double c) { return aerosol_phase(g, c); }), 1, 1e-5) << g;
}

/// Optical depth straight up: exponentials with their heights up to 100 km, and ozone's triangle.
DVec3 vertical_depth(const Atmosphere& air) {
  const double rayleigh = air.rayleigh_height_km * (1 - std::exp(-100 / air.rayleigh_height_km));
  return air.rayleigh_per_km * rayleigh +
         air.aerosol_per_km * (air.aerosol_height_km / air.aerosol_albedo) +
         air.ozone_per_km * air.ozone_reach_km;
}

// Beer's law. The table's path of 128 steps finds aerosols of 1.2 km by steps of 0.8 km: its
// midpoints are off by (0.8 / 1.2)^2 / 24 = 2 % of their depth.
TEST(Atmosphere, StraightUpTheDepthIsThatOfTheLayers) {
  for (const double turbidity : {1.0, 2.0, 4.0}) {
    const Atmosphere air = atmosphere_of(turbidity);
    const AirTables t = make_air_tables(air);
    const DVec3 depth = vertical_depth(air);
    const DVec3 got = transmittance_to_top(t, air.ground_km, 1);
    const double slack =
        0.02 * air.aerosol_per_km.z * air.aerosol_height_km / air.aerosol_albedo + 1e-3;
    EXPECT_NEAR(-std::log(got.x), depth.x, slack) << turbidity;
    EXPECT_NEAR(-std::log(got.y), depth.y, slack) << turbidity;
    EXPECT_NEAR(-std::log(got.z), depth.z, slack) << turbidity;
  }
}

// [Kasten89]: 5.60 times the depth of air at 10 degrees, 10.3 at 5, 26.3 at 1 (with refraction,
// which shortens the lowest path); pure Rayleigh air here, without bending of rays: within 3 %,
// 4 %, 10 %.
TEST(Atmosphere, SlantedPathsAreAsLongAsTheAirMassSays) {
  Atmosphere air = atmosphere_of(1);
  air.ozone_per_km = {};
  const AirTables t = make_air_tables(air);
  const double up = -std::log(transmittance_to_top(t, air.ground_km, 1).x);
  const auto mass = [&](double degrees) {
    const double cosine = std::sin(degrees * kPiDouble / 180);
    return -std::log(transmittance_to_top(t, air.ground_km, cosine).x) / up;
  };
  EXPECT_NEAR(mass(10), 5.60, 0.03 * 5.60);
  EXPECT_NEAR(mass(5), 10.3, 0.04 * 10.3);
  EXPECT_NEAR(mass(1), 26.3, 0.10 * 26.3);
}

// Preetham's turbidity is the ratio of optical depths at 550 nm, ozone left out.
TEST(Atmosphere, TurbidityIsTheRatioOfDepths) {
  for (const double turbidity : {1.0, 2.5, 8.0}) {
    const Atmosphere air = atmosphere_of(turbidity);
    const double rayleigh = air.rayleigh_per_km.y * air.rayleigh_height_km;
    const double haze = air.aerosol_per_km.y / air.aerosol_albedo * air.aerosol_height_km;
    EXPECT_NEAR((rayleigh + haze) / rayleigh, turbidity, 1e-9);
  }
}

// Thin air scatters once: straight up, with the sun at cosine c, L = beta H p(c) E, as everything
// else is of second order in the depth of 0.1 %.
TEST(Atmosphere, ThinAirScattersOnce) {
  Atmosphere air = atmosphere_of(1);
  air.rayleigh_per_km = {1e-4, 1e-4, 1e-4}, air.ozone_per_km = {}, air.ground_albedo = 0;
  const AirTables t = make_air_tables(air);
  const double c = 0.6, depth = 1e-4 * air.rayleigh_height_km;
  const DVec3 l = sky_radiance(t, sky_light(t, sky_ray(t, air.ground_km, 1, 256), c, c), c);
  EXPECT_NEAR(l.y, depth * rayleigh_phase(c), 5e-3 * depth * rayleigh_phase(c));
}

// Light that the ground sends up comes back in part.
TEST(Atmosphere, BrightGroundBrightensTheSky) {
  double before = 0;
  for (const double albedo : {0.0, 0.3, 0.9}) {
    Atmosphere air = atmosphere_of(2);
    air.ground_albedo = albedo;
    const AirTables t = make_air_tables(air);
    const SkyLight light = sky_light(t, sky_ray(t, air.ground_km, 1, 64), 0.6, 0.6);
    const DVec3 l = sky_radiance(t, light, 0.6);
    EXPECT_GT(l.z, before);
    before = l.z;
  }
}

}  // namespace
}  // namespace luxel::scene
