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
  return {plain.samples, first_direct_samples(plain), first_supersample(plain), plain.denoise};
}

void set_quality(Quality quality, const std::function<bool(std::string_view)>& is_given,
                 BakeSettings& settings) {
  const QualityNumbers numbers = numbers_of(quality);
  settings.quality = quality;
  if (!is_given("--samples")) settings.samples = numbers.samples;
  // Shadow rays and points follow samples that somebody asks for.
  const bool follow = is_given("--samples") && !adds_rounds(settings);
  if (!is_given("--direct-samples"))
    settings.direct_samples = follow ? std::optional<int>() : numbers.direct_samples;
  if (!is_given("--supersample"))
    settings.supersample = follow ? std::optional<int>() : numbers.supersample;
  const bool as_sampled =
      is_given("--samples") || settings.max_error > 0 || settings.time_budget_s > 0;
  if (!is_given("--denoise") && !is_given("--no-denoise") && !as_sampled)
    settings.denoise = numbers.denoise;
}

}  // namespace luxel::pipeline
