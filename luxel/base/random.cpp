#include "luxel/base/random.h"

#include "luxel/base/check.h"
#include "luxel/base/sobol_eighths.h"
#include "luxel/base/vectorize.h"

namespace luxel {
inline namespace base {
namespace {

inline uint32_t reverse_bits(uint32_t x) {
  x = ((x >> 1) & 0x55555555u) | ((x & 0x55555555u) << 1);
  x = ((x >> 2) & 0x33333333u) | ((x & 0x33333333u) << 2);
  x = ((x >> 4) & 0x0f0f0f0fu) | ((x & 0x0f0f0f0fu) << 4);
  x = ((x >> 8) & 0x00ff00ffu) | ((x & 0x00ff00ffu) << 8);
  return (x >> 16) | (x << 16);
}

/// The three low bits in reverse order; x < 8.
inline uint8_t reverse_3_bits(uint32_t x) { return uint8_t((x & 1) << 2 | (x & 2) | (x & 4) >> 2); }

// A bijection in which each bit depends only on lower bits: on bit-reversed input this is nested
// (Owen) scrambling. Constants from Vegdahl's search, as published. [Vegdahl21]
inline uint32_t scramble_upwards(uint32_t x, uint32_t seed) {
  x ^= x * 0x3d20adeau;
  x += seed;
  x *= (seed >> 16) | 1u;
  x ^= x * 0x05526c56u;
  x ^= x * 0x53a22864u;
  return x;
}

// The second Sobol dimension, bit-reversed: row k of its generator is row k-1 of Pascal's triangle
// modulo 2, which the loop below unrolls as prefix XORs of the index. [Ahmed24, eq. 12]
inline uint32_t sobol_second_reversed(uint32_t index) {
  index ^= (index & 0xaaaaaaaau) >> 1;
  index ^= (index & 0xccccccccu) >> 2;
  index ^= (index & 0xf0f0f0f0u) >> 4;
  index ^= (index & 0xff00ff00u) >> 8;
  index ^= (index & 0xffff0000u) >> 16;
  return index;
}

}  // namespace

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
    const uint8_t from = reverse_3_bits(k);
    out.x[from] = reverse_3_bits(scramble_upwards(k, uint32_t(seed)) & 7);
    out.y[from] = reverse_3_bits(scramble_upwards(k, uint32_t(seed >> 32)) & 7);
  }
  return out;
}

SobolEighth sobol_eighth(uint32_t index) {
  return {reverse_3_bits(index & 7), reverse_3_bits(sobol_second_reversed(index) & 7)};
}

}  // namespace base
}  // namespace luxel
