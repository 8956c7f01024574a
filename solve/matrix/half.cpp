#include "solve/matrix/half.h"

#include <bit>
#include <cmath>

#include "base/check.h"
#include "solve/matrix/instructions.h"

#if LUXEL_X86_VECTORS
#include <immintrin.h>
#endif

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

#if LUXEL_X86_VECTORS
__attribute__((target("avx2,f16c"))) static size_t convert_eights(const uint16_t* half,
                                                                  size_t count, float* out) {
  size_t k = 0;
  for (; k + 8 <= count; k += 8)
    _mm256_storeu_ps(out + k, _mm256_cvtph_ps(_mm_loadu_si128((const __m128i*)(half + k))));
  return k;
}
#endif

void floats_from_halves(const uint16_t* half, size_t count, float* out) {
  size_t k = 0;
#if LUXEL_X86_VECTORS
  if (instructions() >= Instructions::avx2) k = convert_eights(half, count, out);
#endif
  for (; k < count; ++k) out[k] = float_from_half(half[k]);
}

}  // namespace luxel::matrix
