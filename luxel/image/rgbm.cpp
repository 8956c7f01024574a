#include "luxel/image/rgbm.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "luxel/base/check.h"

namespace luxel::image {
namespace {

float largest_component(const Image& image) {
  float largest = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      largest = std::max(largest, max_component(image.rgb(x, y)));
  return largest;
}

/// The smallest multiplier M = byte / 255 with range M >= m leaves colours the finest steps,
/// range M / 255, of which rounding errs by half of one. M < m / range + 1 / 255 gives the bound.
std::array<uint8_t, 4> to_rgbm(Rgb c, double range) {
  const double m = std::min(double(max_component(c)), range);
  if (!(m > 0)) return {};
  const double multiplier = std::clamp(std::ceil(m / range * 255), 1.0, 255.0);
  std::array<uint8_t, 4> out{0, 0, 0, uint8_t(multiplier)};
  const double unit = range * multiplier / (255 * 255);
  for (int k = 0; k < 3; ++k)
    out[size_t(k)] = uint8_t(std::clamp(std::round(double(c[k]) / unit), 0.0, 255.0));
  return out;
}

}  // namespace

float rgbm_range(std::span<const Image> images) {
  float largest = 0;
  for (const Image& image : images) largest = std::max(largest, largest_component(image));
  // The smallest step of a denormal range would not be a number.
  return largest > 1e-30f ? largest : 1;
}

Image8 rgbm_picture(const Image& image, float range) {
  LUXEL_CHECK(image.channels >= 3 && range > 0);
  for (const float v : image.data) LUXEL_CHECK(std::isfinite(v));
  Image8 out{image.width, image.height, 4, {}};
  out.data.reserve(size_t(image.width) * size_t(image.height) * 4);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const auto code = to_rgbm(image.rgb(x, y), double(range));
      out.data.insert(out.data.end(), code.begin(), code.end());
    }
  return out;
}

RgbmPicture rgbm_picture(const Image& image) {
  const float range = rgbm_range(std::span(&image, 1));
  return {rgbm_picture(image, range), range};
}

}  // namespace luxel::image
