#include "luxel/display/tone_map.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "luxel/base/check.h"
#include "luxel/base/parallel.h"

namespace luxel::display {
namespace {

constexpr float kLinearUpTo = 0.5f;
constexpr double kBrightPercentile = 90;
constexpr float kBrightShownAt = 0.6f;
/// Before the shoulder, which brings 8 to 0.97.
constexpr float kBrightestShownAt = 8;
/// 42 % of a screen's range of values: dark, but all is to be seen.
constexpr float kMeanShownAt = 0.15f;
/// Part of the bright level. What is darker has next to nothing to show beside it.
constexpr float kBlack = 0.002f;

/// The identity up to a = 0.5, then a + (1 - a) t / (1 + t) with t = (x - a) / (1 - a): value and
/// slope continue at a, and 1 is reached only at infinity.
float shoulder(float x) {
  constexpr float a = kLinearUpTo;
  if (x <= a) return x;
  const float t = (x - a) / (1 - a);
  return a + (1 - a) * (1 - 1 / (1 + t));
}

/// Black for NaN and negative light; finite, with room for a square, for what is beyond any screen.
Rgb usable(Rgb c) {
  static constexpr float kMost = 1e18f;
  const auto channel = [](float v) { return v > 0 ? std::min(v, kMost) : 0.0f; };
  return {channel(c.x), channel(c.y), channel(c.z)};
}

/// The value below which a percentage lies; reorders `values`.
float percentile_of(std::vector<float>& values, double percentile) {
  if (values.empty()) return 0;
  const auto rank = size_t(double(values.size() - 1) * percentile / 100);
  std::nth_element(values.begin(), values.begin() + std::ptrdiff_t(rank), values.end());
  return values[rank];
}

/// Luminances of the pixels that show a surface; of all, where none of these has light: the sky is
/// there to see.
std::vector<float> luminances(const image::Image& radiance) {
  std::vector<float> all, surfaces;
  for (int y = 0; y < radiance.height; ++y)
    for (int x = 0; x < radiance.width; ++x) {
      all.push_back(luminance(radiance.rgb(x, y)));
      if (radiance.channels == 3 || radiance.at(x, y)[3] > 0) surfaces.push_back(all.back());
    }
  return std::ranges::any_of(surfaces, [](float v) { return v > 0; }) ? surfaces : all;
}

/// The percentile, that of the pixels with light where it is black; 0 where nothing has light.
/// Reorders `values`.
float bright_level(std::vector<float>& values, double percentile) {
  float bright = percentile_of(values, percentile);
  if (!(bright > 0)) {
    std::erase_if(values, [](float v) { return !(v > 0); });
    bright = percentile_of(values, percentile);
  }
  // A denormal luminance would give an infinite factor.
  return bright > 1e-30f ? bright : 0;
}

}  // namespace

float auto_exposure(const image::Image& radiance, double percentile) {
  LUXEL_CHECK(radiance.channels >= 3 && percentile >= 0 && percentile <= 100);
  std::vector<float> values = luminances(radiance);
  const float bright = bright_level(values, percentile);
  return bright > 0 ? kBrightShownAt / bright : 1.0f;
}

float readable_exposure(const image::Image& radiance) {
  LUXEL_CHECK(radiance.channels >= 3);
  std::vector<float> values = luminances(radiance);
  const float bright = bright_level(values, kBrightPercentile);
  if (!(bright > 0)) return 1;
  double sum = 0;
  size_t count = 0;
  for (const float v : values)
    if (v > kBlack * bright) sum += std::log(double(v)), ++count;
  const auto mean = float(std::exp(sum / double(count)));
  return std::clamp(kMeanShownAt / mean, kBrightShownAt / bright, kBrightestShownAt / bright);
}

/// The largest channel m goes over the shoulder and the others stay in proportion to it, so hue and
/// saturation are those of the light up to m = 1. What is brighter moves slowly towards the grey of
/// its largest channel.
Rgb compress(Rgb exposed) {
  constexpr float kWhitening = 0.15f;
  // Beyond any screen, and far enough from overflow for what follows.
  constexpr float kMost = 1e30f;
  const Rgb c = min(max(exposed, Rgb{}), Rgb{kMost, kMost, kMost});
  const float m = max_component(c);
  if (!(m > 0)) return {};
  const float f = shoulder(m);
  const float kept = 1 / (1 + kWhitening * std::max(0.0f, m - 1));
  const Rgb grey{f, f, f};
  return grey + (c * (f / m) - grey) * kept;
}

float exposure_of_stops(double stops) { return float(std::exp2(stops)); }

Rgb ratio_curve(Rgb exposed, float k) {
  LUXEL_CHECK(k > 0);
  const Rgb c = usable(exposed);
  return {c.x / (k + c.x), c.y / (k + c.y), c.z / (k + c.z)};
}

Rgb reinhard_curve(Rgb exposed, float white) {
  LUXEL_CHECK(white > 0);
  const Rgb c = usable(exposed);
  const float y = luminance(c);
  // The factor, not the new luminance: it stays finite at 0.
  return clamp_curve(c * ((1 + y / (white * white)) / (1 + y)));
}

Rgb filmic_curve(Rgb exposed) {
  const auto curve = [](float x) {
    return (x * (2.51f * x + 0.03f)) / (x * (2.43f * x + 0.59f) + 0.14f);
  };
  const Rgb c = usable(exposed);
  return clamp_curve({curve(c.x), curve(c.y), curve(c.z)});
}

Rgb clamp_curve(Rgb exposed) { return min(usable(exposed), Rgb{1, 1, 1}); }

std::optional<ToneMap> find_tone_map(std::string_view name) {
  for (const NamedToneMap& known : kToneMaps)
    if (known.name == name) return known.curve;
  return std::nullopt;
}

Rgb apply(ToneMap curve, Rgb exposed) {
  switch (curve) {
    case ToneMap::ratio:
      return ratio_curve(exposed);
    case ToneMap::reinhard:
      return reinhard_curve(exposed);
    case ToneMap::filmic:
      return filmic_curve(exposed);
    case ToneMap::clamp:
      return clamp_curve(exposed);
    case ToneMap::shoulder:
      break;
  }
  return compress(exposed);
}

image::Image8 tone_map(const image::Image& radiance, float exposure, ToneMap curve) {
  LUXEL_CHECK(radiance.channels >= 3);
  image::Image shown(radiance.width, radiance.height, 3);
  parallel_for(size_t(radiance.height), 16, [&](size_t begin, size_t end) {
    for (int y = int(begin); y < int(end); ++y)
      for (int x = 0; x < radiance.width; ++x)
        shown.set_rgb(x, y, apply(curve, radiance.rgb(x, y) * exposure));
  });
  return image::to_srgb8(shown);
}

}  // namespace luxel::display
