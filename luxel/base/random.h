// Reproducible randomness: every number is a pure function of a seed and an index.
#pragma once

#include <cstdint>
#include <span>

#include "luxel/base/both_sobol.h"
#include "luxel/base/vec.h"

namespace luxel {
inline namespace base {

/// A well-mixed 64-bit hash (the finaliser of SplitMix64). [Steele14]
inline uint64_t hash64(uint64_t x) {
  x += 0x9e3779b97f4a7c15ull;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
  return x ^ (x >> 31);
}
inline uint64_t hash64(uint64_t a, uint64_t b) { return hash64(hash64(a) ^ b); }

/// [0, 1) from the top 24 bits: exact in a float, never 1.
using both::unit_float;

/// A counter-based stream of uniform numbers in [0, 1).
struct RandomStream {
  uint64_t seed = 0;
  uint64_t index = 0;
  float next() { return unit_float(uint32_t(hash64(seed, index++) >> 32)); }
  Vec2 next2() {
    const uint64_t bits = hash64(seed, index++);
    return {unit_float(uint32_t(bits >> 32)), unit_float(uint32_t(bits))};
  }
};

/// Points 0, 1, 2, ... of the two-dimensional Sobol sequence under Owen scrambling. Every seed
/// gives another randomisation; each aligned block of 2^k points is a (0, k, 2)-net in base 2.
/// Hash-based nested uniform scrambling in each dimension, [Burley20, section 3; Vegdahl21's hash].
/// The index is not shuffled: a pixel uses one seed for one pair of dimensions.
Vec2 sobol_owen_2d(uint32_t index, uint64_t seed);

/// x.size() points of sobol_owen_2d from the one with the index `first` on, bit for bit, several
/// times as fast. x and y are of the same length.
void sobol_owen_2d_points(uint64_t seed, std::span<float> x, std::span<float> y,
                          uint32_t first = 0);

}  // namespace base
}  // namespace luxel
