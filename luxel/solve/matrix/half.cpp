#include "luxel/solve/matrix/half.h"

#include <bit>
#include <cmath>

#include "luxel/base/check.h"

namespace luxel::matrix {

uint16_t half_from_float(float x) {
  const float size = std::fabs(x);
  LUXEL_CHECK(size <= kLargestHalf);
  const auto sign = uint16_t(std::bit_cast<uint32_t>(x) >> 16 & 0x8000);
  // Below 2^-14 halves are multiples of 2^-24. Integers, as denormals may be flushed.
  if (size < 0x1p-14f) return uint16_t(sign | uint16_t(std::nearbyint(size * 0x1p24f)));
  uint32_t bits = std::bit_cast<uint32_t>(size);
  bits += 0x0fff + (bits >> 13 & 1);  // may carry into the exponent, as it should
  return uint16_t(sign | uint16_t((bits >> 13) - ((127 - 15) << 10)));
}

float float_from_half(uint16_t half) {
  const uint32_t size = half & 0x7fffu;
  const float value = size < 0x0400 ? float(size) * 0x1p-24f
                                    : std::bit_cast<float>((size << 13) + ((127u - 15u) << 23));
  return half & 0x8000 ? -value : value;
}

}  // namespace luxel::matrix
