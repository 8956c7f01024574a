// Clear air over a round earth: what it takes from light and where it sends it. [Bruneton08;
// Hillaire20]. For luxel/scene/sky.h. Lengths in km.
#pragma once

#include <vector>

#include "luxel/base/vec.h"
#include "luxel/base/vec_double.h"

namespace luxel::scene {

/// Per channel of linear sRGB, taken as one wavelength each: 680, 550 and 440 nm [Bruneton08].
struct Atmosphere {
  double ground_km = 6360, top_km = 6460;               ///< radii [Hillaire20, table 1]
  DVec3 rayleigh_per_km{5.802e-3, 13.558e-3, 33.1e-3};  ///< at sea level [Hillaire20, table 1]
  double rayleigh_height_km = 8;                        ///< its density falls by e so far up
  DVec3 aerosol_per_km{};                               ///< scattered, at sea level
  double aerosol_albedo = 0.9;  ///< scattered / taken away [Hillaire20: 3.996 / 4.44]
  double aerosol_height_km = 1.2, aerosol_g = 0.8;   ///< [Hillaire20, table 1]
  DVec3 ozone_per_km{0.650e-3, 1.881e-3, 0.085e-3};  ///< taken away at 25 km [Hillaire20, table 1]
  double ozone_height_km = 25, ozone_reach_km = 15;  ///< nothing so far below and above
  double ground_albedo = 0.3;
};

/// Aerosols by Preetham's turbidity T = (air + haze) / air of vertical optical depths, here at 550
/// nm, and Angstrom's law lambda^-1.3 [Preetham99, appendix 1].
Atmosphere atmosphere_of(double turbidity);

/// Coefficients at an altitude [1/km].
struct Medium {
  DVec3 rayleigh, aerosol;  ///< scattered
  DVec3 extinction;
};
Medium medium_at(const Atmosphere& air, double altitude_km);

double rayleigh_phase(double cosine);
/// Cornette's and Shanks' phase function [Hillaire20, section 4].
double aerosol_phase(double g, double cosine);

/// Tables of values that are looked up many times.
struct AirTables {
  Atmosphere air;
  int width = 0, height = 0;         ///< of `transmittance`
  std::vector<DVec3> transmittance;  ///< from a radius, towards a cosine, to the top
  int suns = 0, radii = 0;           ///< of `scattered_again`
  /// Radiance that arrives after two or more scatterings, as if from all sides alike, over the
  /// sun's illuminance above the air: Psi_ms of [Hillaire20, eqs. 5 to 10].
  std::vector<DVec3> scattered_again;
};
AirTables make_air_tables(const Atmosphere& air);
/// `transmittance` alone, from so many heights, 2 or more: that from the ground is the same.
AirTables make_transmittance(const Atmosphere& air, int heights);

/// From a point at `radius_km` along a ray whose cosine with the vertical is `cosine` to the top;
/// what the earth hides is not left out.
DVec3 transmittance_to_top(const AirTables& t, double radius_km, double cosine);
/// Transmittance towards the sun's disc: less as it sets behind the earth.
DVec3 transmittance_to_sun(const AirTables& t, double radius_km, double sun_cosine);

/// A part of a ray's way.
struct AirStep {
  Medium medium;
  double way = 0, radius = 0;  ///< from the ray's start, and of its middle [km]
  DVec3 reaches;  ///< integral over the step of the transmittance back to the start [km]
};
/// Wherever the sun stands, and whichever way the ray looks around the vertical.
struct AirRay {
  double radius = 0;  ///< of its start [km]
  std::vector<AirStep> steps;
  DVec3 through;  ///< transmittance of the whole
};
/// From `eye_km` (from the earth's centre) at a cosine with the vertical, by `steps` steps to the
/// top or the ground.
AirRay sky_ray(const AirTables& t, double eye_km, double cosine, int steps);

/// Light that arrives along a ray. Light that is scattered once comes without its phase functions,
/// which change fast around the sun: the rest is smooth in the angle between ray and sun.
struct SkyLight {
  DVec3 by_air, by_haze;  ///< scattered once
  DVec3 again;            ///< more often
};
/// `sun_cosine`: between the sun and the vertical where the ray starts, `angle`: the cosine between
/// sun and ray. The sun's disc and the ground are left out.
SkyLight sky_light(const AirTables& t, const AirRay& ray, double sun_cosine, double angle);
/// Between two, `part` of the way.
SkyLight mix(const SkyLight& a, const SkyLight& b, double part);
/// Radiance / illuminance of the sun above the air [1/sr] of such light.
DVec3 sky_radiance(const AirTables& t, const SkyLight& light, double angle);

}  // namespace luxel::scene
