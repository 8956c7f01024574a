// Errors of the light of all elements: by noise, and by the size of texels.
#pragma once

#include <vector>

#include "luxel/base/bytes_per_entry.h"
#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/light/direct_light.h"
#include "luxel/light/texel_scene.h"
#include "luxel/solve/gather/bounce/bounces.h"
#include "luxel/solve/gather/budget/expected_rms.h"
#include "luxel/solve/gather/budget/read_check.h"

namespace luxel::gather {

/// Light whose errors are asked for.
struct LightToJudge {
  const light::DirectLight& direct;
  const Bounced& bounced;
  const TracedHits& hits;  ///< with their `sky`
  std::span<const StoredHit> behind;
  const ReadCheck* check = nullptr;  ///< null: nothing was measured
  int bounces = -1;                  ///< BounceParams
};

/// Variances of each element's luminance, on the safe side [(W/m^2)^2], and relative errors by
/// them.
struct LightErrors {
  std::vector<float> noise_variance;    ///< pooled_variances() of direct and gathered light
  std::vector<float> variance;          ///< with what texels cost
  std::vector<float> direct, gathered;  ///< relative_errors() of the noise
  std::vector<float> all;               ///< relative_errors() by `variance`
  float noise_p95 = 0, p95 = 0;         ///< error_p95
  ExpectedSquares expected;
};

/// Memory that light_errors() takes per element [bytes]. Most of it stays in the result.
inline constexpr uint64_t kJudgedBytesPerElement =
    bytes_per_entry(&LightErrors::noise_variance, &LightErrors::variance, &LightErrors::direct,
                    &LightErrors::gathered, &LightErrors::all);

/// Errors: the file of hits cannot be read, cancelled.
Result<LightErrors> light_errors(const light::TexelScene& scene, const LightToJudge& light,
                                 Progress& progress);

}  // namespace luxel::gather
