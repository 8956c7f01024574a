#include "luxel/base/random.h"

#include "luxel/base/both_sobol.h"
#include "luxel/base/check.h"
#include "luxel/base/sobol_eighths.h"
#include "luxel/base/vectorize.h"

namespace luxel {
inline namespace base {
using both::reverse_3_bits;
using both::reverse_bits;
using both::scramble_upwards;
using both::sobol_second_reversed;

Vec2 sobol_owen_2d(uint32_t index, uint64_t seed) {
  // The first dimension is the van der Corput sequence: reversed, it is the index itself.
  const uint32_t x = scramble_upwards(index, uint32_t(seed));
  const uint32_t y = scramble_upwards(sobol_second_reversed(index), uint32_t(seed >> 32));
  return {unit_float(reverse_bits(x)), unit_float(reverse_bits(y))};
}

namespace {

/// The points of index_of(0), index_of(1) and so on, in a loop that becomes vector code.
[[gnu::always_inline]] inline void fill_points(uint64_t seed, std::span<float> x,
                                               std::span<float> y, const auto& index_of) {
  const uint32_t seed_x = uint32_t(seed), seed_y = uint32_t(seed >> 32);
  float* out_x = x.data();
  float* out_y = y.data();
  const uint32_t count = uint32_t(x.size());
  for (uint32_t i = 0; i < count; ++i) {
    const uint32_t index = index_of(i);
    const uint32_t a = reverse_bits(scramble_upwards(index, seed_x)) >> 8;
    const uint32_t b = reverse_bits(scramble_upwards(sobol_second_reversed(index), seed_y)) >> 8;
    // The signed conversion has a vector instruction, and 24 bits fit.
    out_x[i] = float(int32_t(a)) * 0x1p-24f;
    out_y[i] = float(int32_t(b)) * 0x1p-24f;
  }
}

}  // namespace

LUXEL_VECTOR_CLONES
void sobol_owen_2d_points(uint64_t seed, std::span<float> x, std::span<float> y, uint32_t first) {
  LUXEL_CHECK(x.size() == y.size());
  fill_points(seed, x, y, [first](uint32_t i) { return first + i; });
}

LUXEL_VECTOR_CLONES
void sobol_owen_2d_points(uint64_t seed, std::span<const uint32_t> indices, std::span<float> x,
                          std::span<float> y) {
  LUXEL_CHECK(x.size() == indices.size() && y.size() == indices.size());
  fill_points(seed, x, y, [index = indices.data()](uint32_t i) { return index[i]; });
}

// The first three digits of a coordinate are the lowest bits of its reversal, on which alone those
// of the scrambled one depend.
SobolEighths sobol_owen_eighths(uint64_t seed) {
  SobolEighths out;
  for (uint32_t k = 0; k < 8; ++k) {
    const uint32_t from = reverse_3_bits(k);
    out.x[from] = uint8_t(reverse_3_bits(scramble_upwards(k, uint32_t(seed)) & 7));
    out.y[from] = uint8_t(reverse_3_bits(scramble_upwards(k, uint32_t(seed >> 32)) & 7));
  }
  return out;
}

SobolEighth sobol_eighth(uint32_t index) {
  return {uint8_t(reverse_3_bits(index & 7)),
          uint8_t(reverse_3_bits(sobol_second_reversed(index) & 7))};
}

}  // namespace base
}  // namespace luxel
