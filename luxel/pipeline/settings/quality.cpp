#include "luxel/pipeline/settings/quality.h"

namespace luxel::pipeline {

QualityNumbers numbers_of(Quality quality) {
  switch (quality) {
    case Quality::draft:
      return {32, 8, 8, true};
    case Quality::good:
      return {128, 32, 16, true};
    case Quality::best:
      return {1024, 128, 64, false};
    case Quality::none:
      break;
  }
  const BakeSettings plain;
  return {plain.samples, plain.direct_samples, plain.supersample, plain.denoise};
}

void set_quality(Quality quality, const std::function<bool(std::string_view)>& is_given,
                 BakeSettings& settings) {
  const QualityNumbers numbers = numbers_of(quality);
  settings.quality = quality;
  if (!is_given("--samples")) settings.samples = numbers.samples;
  if (!is_given("--direct-samples")) settings.direct_samples = numbers.direct_samples;
  if (!is_given("--supersample")) settings.supersample = numbers.supersample;
  const bool as_sampled = is_given("--samples") || settings.max_error > 0 ||
                          settings.time_budget_s > 0 || settings.layers != light::LayerMode::none;
  if (!is_given("--denoise") && !is_given("--no-denoise") && !as_sampled)
    settings.denoise = numbers.denoise;
}

}  // namespace luxel::pipeline
