// A round of more rays where they lower the root mean square error most for what they cost.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "luxel/light/supersample.h"
#include "luxel/solve/gather/rays/traced_hits.h"

namespace luxel::gather {

/// The known noise of each element, and how it was sampled.
struct NoiseLeft {
  std::span<const float> gathered, direct;  ///< variances [(W/m^2)^2]; 0 where nobody asks for less
  std::span<const uint16_t> samples;        ///< indirect rays
  const light::DirectLevels& levels;
  const TracedHits* guided = nullptr;  ///< whose rays may follow a guide; null: there is none
};

/// A shadow ray over an indirect one: it ends at the first thing that it meets, and is neither
/// sorted nor kept, while an indirect ray's hit is read in every sweep.
inline constexpr double kShadowRay = 0.5;

/// Costs of one element's light, in indirect rays. Rays are counted and not timed, so that the same
/// seed gives the same bits on any machine.
struct RayCosts {
  double sample = 1;                      ///< one more indirect ray, with those that follow it
  double at_sample = 64, at_points = 64;  ///< direct light, as fine as it is at first
};
/// By the rays that each has taken so far on average.
RayCosts ray_costs(double rays_per_sample, double shadow_rays_at_sample,
                   double shadow_rays_at_points);

/// The work of the next round, per element.
struct RoundPlan {
  std::vector<uint16_t> samples;  ///< as many as each element is to have
  std::vector<uint8_t> finer;     ///< 1: its direct light is looked at one level finer
  /// The level of the guide with which an element's rays begin anew; 0, and empty: they do not.
  std::vector<uint8_t> anew{};
};

/// Where the sum of variances falls most for a ray, until it is `allowed` as variances of
/// stratified samples fall, or until rays cost `affordable`. Nothing is done where nothing helps.
RoundPlan plan_rms_round(const NoiseLeft& noise, double allowed, double affordable,
                         const RayCosts& costs, int max_samples);

/// relative_errors() back to variances.
std::vector<float> variances_of(std::span<const float> relative_errors,
                                std::span<const Rgb> irradiance);

}  // namespace luxel::gather
