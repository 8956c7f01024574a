#include "luxel/pipeline/bake/denoise_light.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "luxel/base/check.h"
#include "luxel/base/random.h"
#include "luxel/light/supersample.h"
#include "luxel/pipeline/bake/layers.h"
#include "luxel/pipeline/solver/texel_light.h"
#include "luxel/post/denoise.h"

namespace luxel::pipeline {
namespace {

/// Any number: it sets these shadow rays apart from the first ones.
constexpr uint64_t kAgainSeed = 0xa6a1;
/// Texels between two looks at whether the bake is cancelled.
constexpr size_t kAgainGrain = 64;

/// The direct light of `texels`: averaged over each, or, as the bake has it, at their samples.
/// Errors: cancelled.
Result<std::vector<Rgb>> direct_light_again(const light::TexelScene& in,
                                            const BakeSettings& settings, const TexelLight& light,
                                            std::span<const uint32_t> texels, Progress& progress) {
  light::SupersampleParams params{.points = first_supersample(settings)};
  params.direct.samples = first_direct_samples(settings) * kLookAgain;
  params.direct.seed = hash64(settings.seed, kAgainSeed);
  light::DirectLight direct;
  direct.irradiance = light.direct;
  direct.variance = direct.split_variance = light.direct_variance;
  std::vector<Rgb> out;
  for (size_t begin = 0; begin < texels.size(); begin += kAgainGrain) {
    LUXEL_TRY_STATUS(stopped(progress));
    Progress quiet;  // the stage stays that of the denoiser
    const auto some = texels.subspan(begin, std::min(kAgainGrain, texels.size() - begin));
    if (params.points > 1)
      LUXEL_TRY_STATUS(light::average_texels(in, some, params, direct, quiet));
    else
      LUXEL_TRY_STATUS(light::direct_light_again({in.scene, in.elements, in.lights, in.tracer},
                                                 some, params.direct, direct, quiet));
    for (const uint32_t i : some) out.push_back(direct.irradiance[i]);
  }
  return out;
}

/// The error of light, as its answers tell; nothing where it has none, or no light.
std::optional<double> error_by_answers(const TexelLight& light) {
  const double mean = mean_light(light);
  if (light.answers.elements.empty() || !(mean > 0)) return std::nullopt;
  const double square = light::square_error(light.answers, light.irradiance).mean;
  return std::hypot(std::sqrt(std::max(0.0, square)) / mean, light.relative_unseen);
}

/// The variance that each layer's luminance may have at most: that of all light. Filters
/// lower it to what neighbours show.
std::vector<float> variance_of_layers(const TexelLight& light) {
  std::vector<float> out;
  if (light.layer_irradiance.empty()) return out;
  out = light.variance;
  for (size_t i = 0; i < light.direct_variance.size(); ++i) out[i] += light.direct_variance[i];
  return out;
}

}  // namespace

Status denoise_light(const light::TexelScene& in, const BakeSettings& settings,
                     std::span<const uint32_t> regions, TexelLight& light, Progress& progress,
                     Team* team) {
  LUXEL_CHECK(light.variance.size() == light.irradiance.size());
  const post::DenoiseParams params;
  const post::TexelGeometry places{.scene = in.scene,
                                   .atlas = in.atlas,
                                   .map = in.map,
                                   .position = in.elements.position,
                                   .normal = in.elements.normal,
                                   .hidden = light.hidden,
                                   .region = regions};
  std::vector<Rgb> rest = light.irradiance;
  // A difference of rounded sums may fall below zero.
  for (size_t i = 0; i < light.direct.size(); ++i)
    rest[i] = max(light.irradiance[i] - light.direct[i], Rgb{});
  std::vector<post::NoisyLight> parts{{rest, light.variance}};
  const auto look_again = [&](std::span<const uint32_t> texels) {
    return direct_light_again(in, settings, light, texels, progress);
  };
  if (!light.direct.empty())
    parts.push_back({light.direct, light.direct_variance, true, look_again});
  const std::vector<float> of_layers = variance_of_layers(light);
  for (std::vector<Rgb>& layer : light.layer_irradiance) parts.push_back({layer, of_layers});
  LUXEL_TRY_STATUS(post::denoise(places, parts, params, progress, team));
  for (size_t i = 0; i < light.direct.size(); ++i) rest[i] += light.direct[i];
  light.irradiance = std::move(rest);
  fit_layers(light.irradiance, light.layer_irradiance);
  light.delivered_error = error_by_answers(light);
  return {};
}

}  // namespace luxel::pipeline
