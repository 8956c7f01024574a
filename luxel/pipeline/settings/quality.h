// The numbers that `--quality` stands for.
#pragma once

#include <functional>
#include <string_view>

#include "luxel/pipeline/settings/settings.h"

namespace luxel::pipeline {

/// Gather's samples, and the denoiser.
struct QualityNumbers {
  int samples = 0, direct_samples = 0, supersample = 0;
  bool denoise = false;
};
/// `none`: the numbers that BakeSettings has by itself.
QualityNumbers numbers_of(Quality quality);

/// Sets the numbers of a quality, or with --samples auto for shadow rays and points, where
/// `is_given(flag)` says that the user has not given one. Who says how much light is sampled, by
/// --samples, --max-error or --time-budget, gets it as it was sampled: then the denoiser stays as
/// it is, and so it does with --layers, which it does not filter.
void set_quality(Quality quality, const std::function<bool(std::string_view)>& is_given,
                 BakeSettings& settings);

}  // namespace luxel::pipeline
