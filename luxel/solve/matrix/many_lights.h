// Bounces of several lights by the form factors themselves.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "luxel/solve/matrix/bounces.h"

namespace luxel::matrix {

/// E = F B of several lights, of which 16 share a walk over the factors: those of a large scene are
/// far more than a cache holds. The bits of one light after another.
void multiply(const FormFactors& factors, std::span<const std::span<const Rgb>> radiosity,
              std::span<const std::span<Rgb>> irradiance);

/// Light of all patches, light by light.
using ManyLights = std::vector<std::vector<Rgb>>;

/// Light that patches send by each of several lights, and the patches' properties.
struct SentByMany {
  const ManyLights& radiosity;       ///< what patches send on their own: B_e + rho D [W/m^2]
  std::span<const Rgb> reflectance;  ///< per patch
  std::span<const float> area_m2;    ///< per patch
};

/// count_bounces for each light. Errors: cancelled.
Result<ManyLights> count_bounces(const FormFactors& factors, const SentByMany& sent, int bounces,
                                 Progress& progress);

/// all_bounces for each light, `sweeps` of them at most; `see(irradiance)` is called after each
/// sweep and says whether there should be another. Errors: cancelled.
Result<ManyLights> all_bounces(const FormFactors& factors, const CoarseScene& coarse,
                               const SentByMany& sent, int sweeps,
                               const std::function<bool(const ManyLights&)>& see,
                               Progress& progress);

}  // namespace luxel::matrix
