#include "luxel/solve/matrix/bc1.h"

#include <algorithm>
#include <cmath>

#include "luxel/base/check.h"
#include "luxel/solve/matrix/bc1_block.h"
#include "luxel/solve/matrix/half.h"

namespace luxel::matrix {
namespace {

bool is_permutation(std::span<const uint32_t> order) {
  std::vector<bool> met(order.size());
  for (const uint32_t i : order) {
    if (i >= order.size() || met[i]) return false;
    met[i] = true;
  }
  return true;
}

bool is_readable(uint64_t block) {
  const uint64_t color0 = block & 0xffff, color1 = block >> 16 & 0xffff;
  return color0 > color1 || (color0 == color1 && block >> 32 == 0);
}

}  // namespace

std::array<BlockColor, 4> block_colors(uint64_t block) {
  std::array<BlockColor, 4> out{};
  for (uint32_t e = 0; e < 2; ++e) {
    const uint32_t color = block >> (16 * e) & 0xffff;
    const uint32_t r = color >> 11, g = color >> 5 & 63, b = color & 31;
    out[e] = {r << 3 | r >> 2, g << 2 | g >> 4, b << 3 | b >> 2};
  }
  const bool four = (block & 0xffff) > (block >> 16 & 0xffff);
  for (size_t c = 0; c < 3; ++c) {
    const uint32_t a = out[0][c], b = out[1][c];
    out[2][c] = four ? (2 * a + b) / 3 : (a + b) / 2;
    out[3][c] = four ? (a + 2 * b) / 3 : 0;
  }
  return out;
}

float value_of_byte(uint32_t byte, float log_range) {
  return byte == 0 ? 0.0f : std::exp((float(byte) / 255 - 1) * log_range);
}

std::array<float, 256> byte_values(float log_range) {
  std::array<float, 256> out;
  for (uint32_t byte = 0; byte < 256; ++byte) out[byte] = value_of_byte(byte, log_range);
  return out;
}

bool is_valid(const Bc1& m) {
  const size_t n = m.n;
  const auto finite = [](float x) { return std::isfinite(x); };
  return n <= kMaxBc1Patches && m.log_range > 0 && finite(m.log_range) && m.row.size() == n &&
         m.column.size() == n && m.row_scale.size() == n && m.column_scale.size() == n &&
         m.first_kept.size() == n + 1 &&
         m.blocks.size() == m.blocks_per_row() * m.blocks_per_row() && m.first_kept.front() == 0 &&
         m.first_kept.back() == m.kept.size() &&
         std::is_sorted(m.first_kept.begin(), m.first_kept.end()) && is_permutation(m.row) &&
         is_permutation(m.column) &&
         std::all_of(m.row_scale.begin(), m.row_scale.end(), is_finite) &&
         std::all_of(m.column_scale.begin(), m.column_scale.end(), is_finite) &&
         std::all_of(m.kept_unit.begin(), m.kept_unit.end(), finite) &&
         std::all_of(m.blocks.begin(), m.blocks.end(), is_readable) &&
         std::all_of(m.kept.begin(), m.kept.end(), [n](const Bc1::Kept& k) {
           const auto is_number = [](uint16_t half) { return (half & 0x7c00) != 0x7c00; };
           return k.place < n && std::all_of(k.value.begin(), k.value.end(), is_number);
         });
}

void decode_row(const Bc1& m, size_t place, std::span<Rgb> out) {
  LUXEL_CHECK(place < m.n && out.size() == m.n);
  const std::array<float, 256> value = byte_values(m.log_range);
  const uint64_t* blocks = m.blocks.data() + place / 4 * m.blocks_per_row();
  for (size_t k = 0; k < m.blocks_per_row(); ++k) {
    const std::array<BlockColor, 4> colors = block_colors(blocks[k]);
    for (size_t j = 4 * k; j < std::min<size_t>(4 * k + 4, m.n); ++j) {
      const BlockColor& color = colors[block_index(blocks[k], place % 4, j % 4)];
      out[m.column[j]] = m.row_scale[place] * m.column_scale[j] *
                         Rgb{value[color[0]], value[color[1]], value[color[2]]};
    }
  }
  for (uint32_t k = m.first_kept[place]; k < m.first_kept[place + 1]; ++k) {
    const Bc1::Kept& kept = m.kept[k];
    out[m.column[kept.place]] +=
        m.column_scale[kept.place] * Rgb{float_from_half(kept.value[0]) * m.kept_unit[0],
                                         float_from_half(kept.value[1]) * m.kept_unit[1],
                                         float_from_half(kept.value[2]) * m.kept_unit[2]};
  }
}

uint64_t bytes_of(const Bc1& m) {
  return 8 * (m.blocks.size() + m.kept.size()) +
         4 * (m.row.size() + m.column.size() + m.first_kept.size()) +
         sizeof(Rgb) * (m.row_scale.size() + m.column_scale.size());
}

}  // namespace luxel::matrix
