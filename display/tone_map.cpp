#include "display/tone_map.h"

#include <algorithm>
#include <vector>

#include "base/check.h"
#include "base/parallel.h"

namespace luxel::display {
namespace {

constexpr float kLinearUpTo = 0.5f;

/// The identity up to a = 0.5, then a + (1 - a) t / (1 + t) with t = (x - a) / (1 - a): value and
/// slope continue at a, and 1 is reached only at infinity.
float shoulder(float x) {
  constexpr float a = kLinearUpTo;
  if (x <= a) return x;
  const float t = (x - a) / (1 - a);
  return a + (1 - a) * (1 - 1 / (1 + t));
}

/// The 90th percentile; reorders `values`.
float percentile_90(std::vector<float>& values) {
  if (values.empty()) return 0;
  const size_t rank = (values.size() - 1) * 9 / 10;
  std::nth_element(values.begin(), values.begin() + std::ptrdiff_t(rank), values.end());
  return values[rank];
}

}  // namespace

float auto_exposure(const image::Image& radiance) {
  LUXEL_CHECK(radiance.channels >= 3);
  std::vector<float> values;
  for (int y = 0; y < radiance.height; ++y)
    for (int x = 0; x < radiance.width; ++x)
      if (radiance.channels == 3 || radiance.at(x, y)[3] > 0)
        values.push_back(luminance(radiance.rgb(x, y)));
  float bright = percentile_90(values);
  if (!(bright > 0)) {
    std::erase_if(values, [](float v) { return !(v > 0); });
    bright = percentile_90(values);
  }
  // A denormal luminance would give an infinite factor.
  return bright > 1e-30f ? 0.6f / bright : 1.0f;
}

/// Two shoulders. The first brings luminance Y to f = shoulder(Y) and scales the colour by f / Y.
/// The largest channel m may then still lie above 1, by hue alone: of the room h = 1 - f above grey
/// it wants d = m - f. Moving the colour towards the grey of its own luminance by the factor
/// h shoulder(d / h) / d <= 1 keeps luminance and hue and brings m below 1.
/// With all channels at most 1/2, Y <= m <= 1/2 and d / h = (m - Y) / (1 - Y) <= 1/2: unchanged.
Rgb compress(Rgb exposed) {
  // Beyond any screen, and far enough from overflow for what follows.
  constexpr float kMost = 1e30f;
  const Rgb c = min(max(exposed, Rgb{}), Rgb{kMost, kMost, kMost});
  const float y = luminance(c);
  if (!(y > 0)) return {};
  const float f = shoulder(y);
  const Rgb scaled = c * (f / y);
  const float room = 1 - f, wanted = max_component(scaled) - f;
  if (wanted <= kLinearUpTo * room) return scaled;
  const float saturation = room * shoulder(wanted / room) / wanted;
  const Rgb grey{f, f, f};
  return grey + (scaled - grey) * saturation;
}

image::Image8 tone_map(const image::Image& radiance, float exposure) {
  LUXEL_CHECK(radiance.channels >= 3);
  image::Image shown(radiance.width, radiance.height, 3);
  parallel_for(size_t(radiance.height), 16, [&](size_t begin, size_t end) {
    for (int y = int(begin); y < int(end); ++y)
      for (int x = 0; x < radiance.width; ++x)
        shown.set_rgb(x, y, compress(radiance.rgb(x, y) * exposure));
  });
  return image::to_srgb8(shown);
}

}  // namespace luxel::display
