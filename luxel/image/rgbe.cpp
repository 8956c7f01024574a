#include "luxel/image/rgbe.h"

#include <algorithm>
#include <cmath>

#include "luxel/base/check.h"

namespace luxel::image {

Rgbe to_rgbe(Rgb c) {
  const float m = max_component(c);
  if (!(m > 1e-38f)) return {};
  int exponent = 0;
  (void)std::frexp(m, &exponent);
  // Rounding may carry the largest mantissa to 256: then the next exponent holds it.
  if (std::lround(std::ldexp(double(m), 8 - exponent)) > 255) ++exponent;
  exponent = std::min(exponent, 127);
  Rgbe out{0, 0, 0, uint8_t(exponent + 128)};
  for (int k = 0; k < 3; ++k)
    out[size_t(k)] = uint8_t(std::clamp(std::ldexp(double(c[k]), 8 - exponent) + 0.5, 0.0, 255.0));
  return out;
}

std::array<double, 3> from_rgbe(Rgbe code) {
  const double unit = code[3] ? std::ldexp(1.0, int(code[3]) - (128 + 8)) : 0.0;
  return {code[0] * unit, code[1] * unit, code[2] * unit};
}

Image8 rgbe_picture(const Image& image) {
  LUXEL_CHECK(image.channels >= 3);
  for (const float v : image.data) LUXEL_CHECK(std::isfinite(v));
  Image8 out{image.width, image.height, 4, {}};
  out.data.reserve(size_t(image.width) * size_t(image.height) * 4);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const Rgbe code = to_rgbe(image.rgb(x, y));
      out.data.insert(out.data.end(), code.begin(), code.end());
    }
  return out;
}

}  // namespace luxel::image
