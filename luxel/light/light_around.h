// Light that arrives at points from all sides, by direction: what probes and directional lightmaps
// are made of.
#pragma once

#include <array>
#include <functional>
#include <span>
#include <vector>

#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/base/spherical_harmonics.h"
#include "luxel/light/lights.h"
#include "luxel/scene/scene.h"
#include "luxel/trace/ray_tracer.h"

namespace luxel::light {

/// A scene with its lights, and a solver's answer for E of every surface's front side.
struct LitScene {
  const scene::Scene& scene;
  const trace::RayTracer& tracer;
  const Lights& lights;
  std::function<Rgb(const scene::SurfacePoint&)> irradiance_at;  ///< called by many threads
};

/// Numbers of rays that look around a point.
struct AroundParams {
  int samples = 512;        ///< rays per point towards surfaces and sky
  int direct_samples = 16;  ///< shadow rays per point and direction towards area lights
  uint64_t seed = 1;
};

/// E(n) [W/m^2] at a point in the air as spherical harmonics of the direction n that a surface
/// there would face: E(n) = sum c_k Y_k(n). For natural surroundings that is right to 1 % on
/// average [Ramamoorthi01]; for a single distant light it is off by up to 9 % of the light's
/// irradiance.
struct Probe {
  Vec3 position;
  std::array<Rgb, kSh2> irradiance{};
  float backs = 0;  ///< share of the surfaces around that are seen from behind
};

/// One probe per position, in their order.
struct Probes {
  std::vector<Probe> probes;
  uint64_t rays = 0;
};

/// Direct light of punctual lights is taken for kProbeNormals directions, of which the least
/// squares are the coefficients, with everything that direct_light knows; the rest comes by rays,
/// whose radiance is convolved with the cosine band by band: factors pi, 2 pi / 3, pi / 4. Errors:
/// cancelled.
Result<Probes> light_probes(const LitScene& lit, std::span<const Vec3> positions,
                            const AroundParams& params, Progress& progress);
/// The least squares are then off by 0.4 % of a light's irradiance (root mean square; 1.8 % at
/// most), far less than what nine functions leave out. 24 directions: 1.2 % and 5.4 %.
inline constexpr uint32_t kProbeNormals = 48;

/// Light that arrives at places from surfaces and from the soft light of the surroundings: all of E
/// that direct_light() with no sky_samples leaves.
struct Arriving {
  std::vector<Rgb> reflected, sky;  ///< E per place [W/m^2]
  std::vector<float> backs;         ///< share of the rays that meet the back of a one-sided surface
  uint64_t rays = 0;
};

/// By rays with the density of the cosine about `normals`, samples of them per place; unbiased but
/// for what lit.irradiance_at is off by. Spans are of one length; a place on a surface is moved off
/// it first (scene::off_surface). Errors: cancelled.
Result<Arriving> arriving_light(const LitScene& lit, std::span<const Vec3> positions,
                                std::span<const Vec3> normals, const AroundParams& params,
                                Progress& progress);

/// Change of E when a surface's normal is bent: E(m) = E + (m - n) . V, V a vector per channel.
struct Bent {
  std::array<Rgb, 3> v;  ///< its x, y and z, in the world
};
/// One Bent per position, in their order.
struct BentLight {
  std::vector<Bent> bent;
  uint64_t rays = 0;
};

/// From E for normals that are tilted by kTilt to four sides; light from below the surface itself
/// does not count. Exact for one distant light that none of the four faces away from, and for a sky
/// of one colour. Spans are of one length. Errors: cancelled.
Result<BentLight> bent_irradiance(const LitScene& lit, std::span<const Vec3> positions,
                                  std::span<const Vec3> normals,
                                  std::span<const Vec3> geometric_normals,
                                  const AroundParams& params, Progress& progress);
/// In radians: 40 degrees, as steep as normal maps lean. V is a difference over the range in which
/// it is used, not a slope at a point.
inline constexpr float kTilt = 0.7f;

}  // namespace luxel::light
