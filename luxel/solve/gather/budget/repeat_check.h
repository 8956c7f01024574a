// Measures noise: lights some elements once more with other random numbers.
//
// Variances that rays tell of themselves are those of fewer, or of independent rays, and stratified
// rays do better than that by a factor that differs from scene to scene. Two results of as many
// rays each, which share no random number, differ by twice the variance of either in the mean
// square, whatever the sampling does.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>

#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/light/chosen_elements.h"
#include "luxel/light/supersample.h"
#include "luxel/light/texel_scene.h"
#include "luxel/solve/gather/rays/traced_hits.h"
#include "luxel/transport/own_side.h"

namespace luxel::gather {

struct RepeatParams {
  light::SupersampleParams
      direct;                ///< as the light's, and its team; parts and layers are not looked at
  bool follows_near = true;  ///< as TraceParams has it
  uint64_t memory_limit_bytes = UINT64_MAX;  ///< for hits; the rest goes to temporary files
  std::filesystem::path scratch_folder = ".";
};

/// Light whose noise is measured.
struct LightToRepeat {
  const light::DirectLight& direct;
  const light::DirectLevels& levels;
  const TracedHits& hits;
  std::span<const StoredHit> behind;
  std::span<const Rgb> irradiance;        ///< E per element, after all bounces [W/m^2]
  std::span<const float> noise_variance;  ///< what is believed of its luminance's variance
};

/// Noise as noise_by_repeating() measures it.
struct TrueNoise {
  double over_believed = 1;    ///< the sum of variances over that of noise_variance
  double share_of_direct = 0;  ///< what direct light has of it
};

/// The true sum of variances. Some hundred elements are chosen, half of them in proportion to what
/// they have of the sum of noise_variance. Of m elements with alike variances it is known
/// to sqrt(2 / m), and its root to half of that: 3 % of 512, 1.6 % of 2,048. 1 where there is no
/// noise. Errors: cancelled, disk full.
Result<TrueNoise> noise_by_repeating(const light::TexelScene& in, const transport::OwnSides& sides,
                                     const LightToRepeat& light, const RepeatParams& params,
                                     Progress& progress);

/// Two answers for some hundred elements, more precise than their light: they cost a fiftieth of
/// its rays, or what 128 elements take. Direct light is averaged over texels, where it is anywhere.
/// Rays read `light.irradiance`, after all bounces. No `enclosed` elements are asked.
/// Errors: cancelled, disk full.
Result<light::Answers> answers_by_repeating(const light::TexelScene& in,
                                            const transport::OwnSides& sides,
                                            const LightToRepeat& light,
                                            std::span<const uint8_t> enclosed,
                                            const RepeatParams& params, Progress& progress);

}  // namespace luxel::gather
