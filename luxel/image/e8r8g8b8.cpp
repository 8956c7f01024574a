#include "luxel/image/e8r8g8b8.h"

#include <algorithm>
#include <cmath>

#include "luxel/base/check.h"

namespace luxel::image {
namespace {

constexpr int kBias = 128, kMostExponent = 127;

/// NaN fails every comparison.
double usable(float v) { return v > 0 ? double(std::min(v, kMostE8R8G8B8)) : 0.0; }

/// The smallest e with 2^e >= x > 0.
int exponent_at_least(double x) {
  int e = 0;
  return std::frexp(x, &e) == 0.5 ? e - 1 : e;  // x = m 2^e with m in [1/2, 1)
}

uint8_t byte_of(double share) { return uint8_t(std::min(255.0, std::round(share * 255))); }

}  // namespace

/// The paper takes the range 2^e at or above the largest component m. Rounding to bytes then errs
/// by up to 2^e / 510, which is m / 255 where m is just above 2^(e-1). Here the range may lie below
/// m by one part in 256, where the largest byte stands for all of it: then m >= 2^(e-1) 256/255
/// whenever the range is 2^e, and both errors, m - 2^e and 2^e / 510, are at most m / 256.
E8R8G8B8 to_e8r8g8b8(Rgb color) {
  const double r = usable(color.x), g = usable(color.y), b = usable(color.z);
  const double most = std::max({r, g, b});
  if (most == 0) return {};
  const int e = std::clamp(exponent_at_least(most * 255 / 256), -kBias, kMostExponent);
  const double range = std::ldexp(1.0, e);
  const E8R8G8B8 code{uint8_t(e + kBias), byte_of(r / range), byte_of(g / range),
                      byte_of(b / range)};
  return code.r == 0 && code.g == 0 && code.b == 0 ? E8R8G8B8{} : code;
}

/// In double: the smallest ones are denormal floats, which parallel loops flush to zero.
Rgb from_e8r8g8b8(E8R8G8B8 code) {
  const double step = std::ldexp(1.0 / 255, int(code.e) - kBias);
  return {float(double(code.r) * step), float(double(code.g) * step), float(double(code.b) * step)};
}

uint32_t pack(E8R8G8B8 c) {
  return uint32_t(c.e) << 24 | uint32_t(c.r) << 16 | uint32_t(c.g) << 8 | uint32_t(c.b);
}

E8R8G8B8 unpack_e8r8g8b8(uint32_t bits) {
  return {uint8_t(bits >> 24), uint8_t(bits >> 16), uint8_t(bits >> 8), uint8_t(bits)};
}

std::vector<uint32_t> encode_e8r8g8b8(const Image& image) {
  LUXEL_CHECK(image.channels >= 3);
  std::vector<uint32_t> codes;
  codes.reserve(size_t(image.width) * size_t(image.height));
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) codes.push_back(pack(to_e8r8g8b8(image.rgb(x, y))));
  return codes;
}

Image decode_e8r8g8b8(const std::vector<uint32_t>& codes, int width, int height) {
  LUXEL_CHECK(codes.size() == size_t(width) * size_t(height));
  Image image(width, height, 3);
  for (size_t i = 0; i < codes.size(); ++i) {
    const Rgb c = from_e8r8g8b8(unpack_e8r8g8b8(codes[i]));
    image.data[3 * i] = c.x, image.data[3 * i + 1] = c.y, image.data[3 * i + 2] = c.z;
  }
  return image;
}

}  // namespace luxel::image
