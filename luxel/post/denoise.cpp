#include "luxel/post/denoise.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "luxel/base/check.h"
#include "luxel/base/parallel.h"
#include "luxel/post/grow_planes.h"
#include "luxel/post/noise_level.h"
#include "luxel/post/oidn.h"
#include "luxel/post/outliers.h"

namespace luxel::post {
namespace {

/// Radii of the rounds: windows hold about 9, 21, 49, 113 and 253 texels.
constexpr float kRadii[] = {1.6f, 2.5f, 4, 6, 9};
/// The first round compares single texels: only what noise cannot explain at all is kept apart, so
/// that no outlier stands alone for ever.
constexpr float kFirstDeviations = 2;

/// Standard deviation over luminance, 1 at most: black has no colour to be given light in.
float relative_noise(Rgb value, float variance) {
  const float l = luminance(value);
  return l > 0 ? std::min(1.0f, std::sqrt(variance) / l) : 0.0f;
}

/// No more than this part of the light is given back: more is not the skew of noise.
constexpr double kMostGivenBack = 0.2;

/// Sums of values, and of values times relative noise, over texels that have noise.
struct Balance {
  std::array<double, 3> light{}, noise{};
};
Balance balance_of(const Neighbourhood& n, const NoiseLevel& noise, std::span<const Rgb> values) {
  Balance sum;
  for (size_t i = 0; i < values.size(); ++i) {
    if (n.place[i].spacing <= 0 || noise.variance[i] <= 0) continue;
    const float relative = relative_noise(values[i], noise.variance[i]);
    for (int c = 0; c < 3; ++c) {
      sum.light[size_t(c)] += double(values[i][c]);
      sum.noise[size_t(c)] += double(values[i][c] * relative);
    }
  }
  return sum;
}

/// Gives back what the filter has taken from the sum of the light, or takes what it has added, in
/// proportion to light and to how noisy it was. Noise of few samples is skewed, and planes through
/// what agrees lean towards its median, by as much as there is noise.
void keep_sum(const Neighbourhood& n, const NoiseLevel& noise, const Balance& before,
              std::span<Rgb> values) {
  const Balance after = balance_of(n, noise, values);
  const auto share = [&](size_t c) {
    if (!(after.noise[c] > 0)) return 0.0f;
    return float(std::clamp((before.light[c] - after.light[c]) / after.noise[c], -kMostGivenBack,
                            kMostGivenBack));
  };
  const Rgb factor{share(0), share(1), share(2)};
  for (size_t i = 0; i < values.size(); ++i) {
    if (n.place[i].spacing <= 0 || noise.variance[i] <= 0) continue;
    values[i] += values[i] * factor * relative_noise(values[i], noise.variance[i]);
  }
}

/// The fireflies of a part; of direct light those that are none on a closer look left out.
Result<std::vector<Firefly>> fireflies_of(const Neighbourhood& n, const NoiseLevel& noise,
                                          const NoisyLight& part, Team* team, Progress& progress) {
  if (part.is_direct && !part.look_again) return std::vector<Firefly>{};
  LUXEL_TRY(std::vector<Firefly> found,
            find_fireflies(n, {part.values, part.variance, noise, part.is_direct}, team, progress));
  if (!part.is_direct || found.empty()) return found;
  std::vector<uint32_t> texels;
  for (const Firefly& f : found) texels.push_back(f.texel);
  LUXEL_TRY(const std::vector<Rgb> seen, part.look_again(texels));
  LUXEL_CHECK(seen.size() == found.size());
  for (size_t k = 0; k < found.size(); ++k) found[k].luminance = luminance(seen[k]);
  std::erase_if(found,
                [&](const Firefly& f) { return !(f.luminance < luminance(part.values[f.texel])); });
  return found;
}

/// Units of Progress of all parts.
uint64_t units_of(std::span<const NoisyLight> parts, const DenoiseParams& params) {
  uint64_t of_rounds = 0, units = 0;
  for (const float radius : kRadii)
    if (radius <= params.radius) of_rounds += grow_units(radius);
  for (const NoisyLight& part : parts) {
    const auto noisy = std::ranges::count_if(part.variance, [](float v) { return v > 0; });
    units += part.values.size() * kNoiseLevelUnits + uint64_t(noisy) * of_rounds;
  }
  return units;
}

/// Filters one part in place.
Status filter(const Neighbourhood& n, const DenoiseParams& params, const NoisyLight& part,
              Team* team, Progress& progress) {
  LUXEL_TRY(const NoiseLevel noise, noise_level(n, part.values, part.variance, team, progress));
  const Balance before = balance_of(n, noise, part.values);
  LUXEL_TRY(const std::vector<Firefly> fireflies, fireflies_of(n, noise, part, team, progress));
  share_out(n, part.variance, fireflies, part.values);
  Planes planes{std::vector<Plane>(part.values.size()), std::vector<Shown>(part.values.size())};
  std::vector<Plane>& now = planes.planes;
  for (size_t i = 0; i < now.size(); ++i) now[i] = {part.values[i], {}, {}, noise.variance[i], 0};
  float deviations = params.max_deviations * kFirstDeviations;
  for (const float radius : kRadii) {
    if (radius > params.radius) break;
    LUXEL_TRY_STATUS(
        grow(n, noise, part.values, {radius, deviations * deviations}, planes, team, progress));
    deviations = params.max_deviations;
  }
  for (size_t i = 0; i < now.size(); ++i) {
    if (n.place[i].spacing <= 0 || noise.variance[i] <= 0) continue;
    if (is_finite(now[i].value)) part.values[i] = max(now[i].value, Rgb{});
  }
  keep_sum(n, noise, before, part.values);
  return {};
}

}  // namespace

Status denoise(const TexelGeometry& places, std::span<const NoisyLight> parts,
               const DenoiseParams& params, Progress& progress, Team* team) {
  for (const NoisyLight& part : parts) {
    LUXEL_CHECK(part.values.size() == places.map.texels.size());
    LUXEL_CHECK(part.variance.size() == part.values.size());
    for (const Rgb& v : part.values) LUXEL_CHECK(is_finite(v) && min_component(v) >= 0);
    for (const float v : part.variance) LUXEL_CHECK(std::isfinite(v) && v >= 0);
  }
  progress.begin("denoise",
                 places.map.texels.size() * kNeighbourhoodUnits + units_of(parts, params));
  if (kHasOidn) return denoise_with_oidn(places, parts, progress);
  LUXEL_TRY(const Neighbourhood n, make_neighbourhood(places, params, team, progress));
  for (const NoisyLight& part : parts) LUXEL_TRY_STATUS(filter(n, params, part, team, progress));
  return {};
}

}  // namespace luxel::post
