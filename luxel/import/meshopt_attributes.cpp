#include "luxel/import/meshopt_attributes.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <optional>

namespace luxel::import {
namespace {

using MeshoptBytes = std::span<const uint8_t>;

constexpr size_t kGroup = 16, kMostOfBlock = 256;

/// The next bytes; none when fewer are left.
std::optional<MeshoptBytes> next_bytes(MeshoptBytes& left, size_t count) {
  if (count > left.size()) return std::nullopt;
  const MeshoptBytes out = left.first(count);
  left = left.subspan(count);
  return out;
}

/// 16 deltas of `bits` bits each. One whose bits are all 1 stands behind them as a whole byte.
bool read_group(MeshoptBytes& left, unsigned bits, uint8_t* out) {
  if (bits == 0) {
    std::fill_n(out, kGroup, uint8_t(0));
    return true;
  }
  const auto packed = next_bytes(left, kGroup * bits / 8);
  if (!packed) return false;
  const unsigned per_byte = 8 / bits, all_ones = (1u << bits) - 1;
  for (unsigned i = 0; i < kGroup; ++i) {
    const unsigned at = i % per_byte;
    // The first of a byte has its highest bits, but its lowest where each is one bit.
    const unsigned shift = bits == 1 ? at : 8 - bits * (at + 1);
    out[i] = uint8_t((*packed)[i / per_byte] >> shift & all_ones);
    if (bits == 8 || out[i] != all_ones) continue;
    const auto whole = next_bytes(left, 1);
    if (!whole) return false;
    out[i] = whole->front();
  }
  return true;
}

/// The deltas of one byte of each element of a block, filled up to whole groups.
bool read_deltas(MeshoptBytes& left, unsigned control, size_t count, uint8_t* out) {
  constexpr unsigned kBits[2][4] = {{0, 1, 2, 4}, {1, 2, 4, 8}};
  if (control >= 2) {
    const auto plain = next_bytes(left, control == 3 ? count : 0);
    if (!plain) return false;
    std::fill_n(out, count, uint8_t(0));
    std::copy(plain->begin(), plain->end(), out);
    return true;
  }
  const size_t groups = (count + kGroup - 1) / kGroup;
  const auto widths = next_bytes(left, (groups + 3) / 4);
  if (!widths) return false;
  for (size_t i = 0; i < groups; ++i)
    if (!read_group(left, kBits[control][(*widths)[i / 4] >> (i % 4 * 2) & 3], out + kGroup * i))
      return false;
  return true;
}

template <class T>
T from_zigzag(T v) {
  return T((v & 1) != 0 ? ~(v >> 1) : v >> 1);
}

/// Four bytes of an element, from those of the element before. `mode` has passed is_mode().
uint32_t next_value(uint32_t before, uint32_t delta, uint8_t mode) {
  if ((mode & 15) == 2) return before ^ std::rotr(delta, mode >> 4);
  uint32_t out = 0;
  if (mode == 1) {
    for (const unsigned shift : {0u, 16u})
      out |= uint32_t(uint16_t((before >> shift) + from_zigzag(uint16_t(delta >> shift)))) << shift;
  } else {
    for (const unsigned shift : {0u, 8u, 16u, 24u})
      out |= uint32_t(uint8_t((before >> shift) + from_zigzag(uint8_t(delta >> shift)))) << shift;
  }
  return out;
}

/// Only exclusive or has a rotation.
bool is_mode(uint8_t mode) { return mode <= 1 || (mode & 15) == 2; }

uint32_t word_at(const uint8_t* bytes) {
  return uint32_t(bytes[0]) | uint32_t(bytes[1]) << 8 | uint32_t(bytes[2]) << 16 |
         uint32_t(bytes[3]) << 24;
}

/// `before`: the element before the block.
bool read_block(MeshoptBytes& left, MeshoptBytes modes, const uint8_t* before, size_t stride,
                std::span<uint8_t> out) {
  const size_t count = out.size() / stride;
  const auto controls = next_bytes(left, stride / 4);
  if (!controls) return false;
  std::array<std::array<uint8_t, kMostOfBlock>, 4> deltas;
  for (size_t channel = 0; channel < stride / 4; ++channel) {
    for (size_t k = 0; k < 4; ++k)
      if (!read_deltas(left, (*controls)[channel] >> (2 * k) & 3, count, deltas[k].data()))
        return false;
    uint32_t value = word_at(before + 4 * channel);
    for (size_t i = 0; i < count; ++i) {
      const uint8_t delta[] = {deltas[0][i], deltas[1][i], deltas[2][i], deltas[3][i]};
      value = next_value(value, word_at(delta), modes[channel]);
      for (size_t k = 0; k < 4; ++k) out[i * stride + 4 * channel + k] = uint8_t(value >> (8 * k));
    }
  }
  return true;
}

/// The element's numbers, T unsigned and S signed, of the same size.
template <class T, class S>
void decode_color(uint8_t* element) {
  const auto number = [&](size_t i) {
    T v = 0;
    for (size_t k = 0; k < sizeof(T); ++k) v = T(v | element[sizeof(T) * i + k] << (8 * k));
    return v;
  };
  const int y = number(0), co = S(number(1)), cg = S(number(2)), alpha = number(3);
  // The highest bit of alpha says how many bits the numbers have: none is damage, and black.
  const int most = (1 << std::bit_width(unsigned(alpha))) - 1;
  const int a = alpha & most >> 1;
  const int rgba[] = {y + co - cg, y + cg, y - co - cg, a << 1 | (a & 1)};
  for (size_t i = 0; i < 4; ++i) {
    const auto value =
        T(most == 0 ? 0 : std::lround(double(std::clamp(rgba[i], 0, most)) * T(-1) / most));
    for (size_t k = 0; k < sizeof(T); ++k) element[sizeof(T) * i + k] = uint8_t(value >> (8 * k));
  }
}

}  // namespace

bool decode_attributes(std::span<const uint8_t> stream, size_t stride, std::span<uint8_t> out) {
  const size_t end = stride + stride / 4;  // the element before the first, and the modes
  const size_t padded_end = std::max<size_t>(end, 24);
  if (stream.size() < padded_end) return false;
  const MeshoptBytes modes = stream.last(stride / 4);
  if (!std::all_of(modes.begin(), modes.end(), is_mode)) return false;
  MeshoptBytes left = stream.first(stream.size() - padded_end);
  const size_t most = std::min((8192 / stride) & ~(kGroup - 1), kMostOfBlock) * stride;
  const uint8_t* before = stream.last(end).data();
  for (size_t at = 0; at < out.size(); at += most) {
    const auto block = out.subspan(at, std::min(most, out.size() - at));
    if (!read_block(left, modes, before, stride, block)) return false;
    before = block.last(stride).data();
  }
  return left.empty();
}

void decode_colors(size_t stride, std::span<uint8_t> elements) {
  for (size_t at = 0; at < elements.size(); at += stride)
    stride == 4 ? decode_color<uint8_t, int8_t>(&elements[at])
                : decode_color<uint16_t, int16_t>(&elements[at]);
}

}  // namespace luxel::import
