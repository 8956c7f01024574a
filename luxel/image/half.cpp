#include "luxel/image/half.h"

#include <Imath/half.h>

#include <algorithm>
#include <cmath>

#include "luxel/base/check.h"
#include "luxel/base/parallel.h"

namespace luxel::image {
namespace {

constexpr int kTopExponent = 15;  ///< scaled colours lie below 2^15
constexpr float kLargestHalf = 65504;
constexpr size_t kGrain = 1 << 16;

/// The largest number of an image that is no alpha. All must be finite.
float largest_of(const Image& image) {
  std::vector<float> of_part((image.data.size() + kGrain - 1) / kGrain);
  parallel_for(image.data.size(), kGrain, [&](size_t begin, size_t end) {
    float largest = 0;
    for (size_t i = begin; i < end; ++i) {
      LUXEL_CHECK(std::isfinite(image.data[i]));
      if (image.channels < 4 || i % size_t(image.channels) < 3)
        largest = std::max(largest, std::abs(image.data[i]));
    }
    of_part[begin / kGrain] = largest;
  });
  return of_part.empty() ? 0 : *std::ranges::max_element(of_part);
}

float scale_of(float largest) {
  if (!(largest > 0)) return 1;
  int exponent = 0;  // largest = m 2^exponent with m in [1/2, 1)
  (void)std::frexp(largest, &exponent);
  return std::ldexp(1.0f, std::clamp(exponent - kTopExponent, -100, 127));
}

}  // namespace

HalfImage to_half(const Image& image) { return to_half(image, scale_of(largest_of(image))); }

float scale_for_files(std::span<const Image> images) {
  float largest = 0;
  for (const Image& image : images) largest = std::max(largest, largest_of(image));
  return largest >= 0.125f && largest <= kLargestHalf ? 1 : scale_of(largest);
}

HalfImage to_half(const Image& image, float scale) {
  LUXEL_CHECK(image.channels >= 1 && scale > 0);
  HalfImage out{image.width, image.height, image.channels, scale, {}};
  out.data.resize(image.data.size());
  const size_t channels = size_t(image.channels);
  parallel_for(image.data.size(), kGrain, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      LUXEL_CHECK(std::isfinite(image.data[i]));
      const bool is_alpha = channels == 4 && i % channels == 3;
      const float scaled = is_alpha ? image.data[i] : image.data[i] / out.scale;
      out.data[i] = Imath::half(std::clamp(scaled, -kLargestHalf, kLargestHalf)).bits();
    }
  });
  return out;
}

float from_half(uint16_t bits) { return Imath::half(Imath::half::FromBits, bits); }

}  // namespace luxel::image
