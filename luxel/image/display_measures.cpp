#include "luxel/image/display_measures.h"

#include <algorithm>
#include <cstdlib>

#include "luxel/base/check.h"

namespace luxel::image {

std::vector<uint8_t> brightness(const Image8& image) {
  LUXEL_CHECK(image.channels >= 3);
  const size_t channels = size_t(image.channels);
  std::vector<uint8_t> out(size_t(image.width) * size_t(image.height));
  for (size_t i = 0; i < out.size(); ++i) {
    const uint8_t* p = image.data.data() + channels * i;
    out[i] = uint8_t((2126u * p[0] + 7152u * p[1] + 722u * p[2] + 5000u) / 10000u);
  }
  return out;
}

std::vector<uint8_t> pixel_differences(const Image8& a, const Image8& b) {
  LUXEL_CHECK(a.width == b.width && a.height == b.height);
  LUXEL_CHECK(a.channels >= 3 && b.channels >= 3);
  std::vector<uint8_t> out(size_t(a.width) * size_t(a.height));
  for (size_t i = 0; i < out.size(); ++i)
    for (size_t c = 0; c < 3; ++c) {
      const int d = int(a.data[size_t(a.channels) * i + c]) - b.data[size_t(b.channels) * i + c];
      out[i] = std::max(out[i], uint8_t(std::abs(d)));
    }
  return out;
}

Histogram histogram(std::span<const uint8_t> values, const Mask& covered) {
  LUXEL_CHECK(values.size() == covered.size());
  Histogram counts{};
  for (size_t i = 0; i < values.size(); ++i)
    if (covered[i]) ++counts[values[i]];
  return counts;
}

double share_above(const Histogram& counts, uint8_t level) {
  uint64_t all = 0, above = 0;
  for (size_t v = 0; v < counts.size(); ++v) {
    all += counts[v];
    if (v > level) above += counts[v];
  }
  return all ? double(above) / double(all) : 0;
}

std::vector<uint8_t> contours(std::span<const uint8_t> values, int width, const Mask& covered,
                              std::span<const uint8_t> levels) {
  LUXEL_CHECK(width > 0 && values.size() % size_t(width) == 0);
  LUXEL_CHECK(values.size() == covered.size() && levels.size() < 255);
  const size_t w = size_t(width), count = values.size();
  std::vector<uint8_t> out(count);
  for (size_t i = 0; i < count; ++i) {
    if (!covered[i]) continue;
    const size_t x = i % w;
    uint8_t lowest = values[i];
    const auto look = [&](bool there, size_t j) {
      if (there && covered[j]) lowest = std::min(lowest, values[j]);
    };
    look(x + 1 < w, i + 1);
    look(x > 0, i - 1);
    look(i + w < count, i + w);
    look(i >= w, i - w);
    for (size_t k = 0; k < levels.size(); ++k)
      if (values[i] >= levels[k] && lowest < levels[k]) out[i] = uint8_t(k + 1);
  }
  return out;
}

}  // namespace luxel::image
