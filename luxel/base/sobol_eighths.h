// Some of the points of luxel/base/random.h's Sobol sequence: in which part of the square they lie,
// without making them, for scrambling moves whole eighths of an axis; and points of some indices.
#pragma once

#include <array>
#include <cstdint>
#include <span>

namespace luxel {
inline namespace base {

/// In which eighths of the two axes, numbered from 0, a point lies.
struct SobolEighth {
  uint8_t x = 0, y = 0;
};
/// The eighths in which a point of the plain sequence lies, which is not scrambled.
SobolEighth sobol_eighth(uint32_t index);

/// Where Owen scrambling moves each eighth of an axis: sobol_owen_2d(index, seed) lies in the
/// eighths x[e.x] and y[e.y] with e = sobol_eighth(index).
struct SobolEighths {
  std::array<uint8_t, 8> x{}, y{};
};
SobolEighths sobol_owen_eighths(uint64_t seed);

/// sobol_owen_2d of some indices, bit for bit, several times as fast. All three are of the same
/// length.
void sobol_owen_2d_points(uint64_t seed, std::span<const uint32_t> indices, std::span<float> x,
                          std::span<float> y);

}  // namespace base
}  // namespace luxel
