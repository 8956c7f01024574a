// Decodes blocks of BC1.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace luxel::matrix {

using BlockColor = std::array<uint32_t, 3>;  ///< 8 bits per channel

/// The colours of a block's indices 0..3, in either mode: between its two colours lie two more in
/// thirds, or one half way and black. Whole numbers, rounded down.
std::array<BlockColor, 4> block_colors(uint64_t block);

/// The index of an entry.
inline size_t block_index(uint64_t block, size_t row, size_t column) {
  return block >> (32 + 2 * (4 * row + column)) & 3;
}

/// The values of all 8-bit entries.
std::array<float, 256> byte_values(float log_range);

}  // namespace luxel::matrix
