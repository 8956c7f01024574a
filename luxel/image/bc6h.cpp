#include "luxel/image/bc6h.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "luxel/base/check.h"
#include "luxel/base/parallel.h"

namespace luxel::image {
namespace {

constexpr int kSide = 4, kPixels = kSide * kSide;
constexpr uint16_t kLargestBits = 0x7bff;

using Ints = std::array<int, 3>;
using Floats = std::array<float, 3>;

/// A kind of block: its number, the bits of the first end, and of the second end's difference from
/// it. With as many bits for both, the second end stands there itself.
struct Mode {
  uint32_t number = 0;
  int bits = 0, difference_bits = 0;
  bool has_differences() const { return difference_bits != bits; }
};
constexpr std::array<Mode, 4> kModes{Mode{0x0f, 16, 4}, Mode{0x0b, 12, 8}, Mode{0x07, 11, 9},
                                     Mode{0x03, 10, 10}};

/// Sixty-fourths of the second end that the 16 colours between the ends have.
constexpr std::array<int, 16> kWeights{0, 4, 9, 13, 17, 21, 26, 30, 34, 38, 43, 47, 51, 55, 60, 64};

/// A block's pixels as the bits of halves. Distances between these are those of logarithms, nearly,
/// as the card's colours between ends are.
struct Pixels {
  std::array<Floats, kPixels> value{};
  std::array<float, kPixels> weight{};
};

/// The two ends of a block, quantised, and which colour between them each pixel has.
struct Fit {
  const Mode* mode = nullptr;
  std::array<Ints, 2> end{};
  std::array<int, kPixels> index{};
  float error = INFINITY;
};

/// A quantised number as the card spreads it over 16 bits.
int spread(int quantised, int bits) {
  if (bits >= 15 || quantised == 0) return quantised;
  if (quantised == (1 << bits) - 1) return 0xffff;
  return ((quantised << 16) + 0x8000) >> bits;
}
/// The bits of a half that become of it.
int half_bits(int spread) { return (spread * 31) >> 6; }

/// The quantised number whose half is nearest.
int quantise(float half, int bits) {
  const int most = bits == 16 ? (int(kLargestBits) * 64 + 30) / 31 : (1 << bits) - 1;
  const int guess = int(std::lround(half * (64.0f / 31) * std::ldexp(1.0f, bits - 16)));
  int best = 0;
  float distance = INFINITY;
  for (int q = std::clamp(guess - 1, 0, most); q <= std::clamp(guess + 1, 0, most); ++q) {
    const float d = std::abs(float(half_bits(spread(q, bits))) - half);
    if (d < distance) best = q, distance = d;
  }
  return best;
}

/// True: a block of this mode can hold both ends, either way round.
bool can_hold(const Mode& mode, const std::array<Ints, 2>& end) {
  if (!mode.has_differences()) return true;
  const int most = (1 << (mode.difference_bits - 1)) - 1;
  for (size_t c = 0; c < 3; ++c)
    if (std::abs(end[1][c] - end[0][c]) > most) return false;
  return true;
}

/// Chooses the nearest colour for each pixel; sets index and error.
void choose_colors(const Pixels& pixels, Fit& fit) {
  std::array<Floats, 16> color{};
  for (size_t k = 0; k < color.size(); ++k)
    for (size_t c = 0; c < 3; ++c) {
      const int a = spread(fit.end[0][c], fit.mode->bits),
                b = spread(fit.end[1][c], fit.mode->bits);
      color[k][c] = float(half_bits((a * (64 - kWeights[k]) + b * kWeights[k] + 32) >> 6));
    }
  fit.error = 0;
  for (size_t i = 0; i < kPixels; ++i) {
    float nearest = INFINITY;
    for (size_t k = 0; k < color.size(); ++k) {
      float d = 0;
      for (size_t c = 0; c < 3; ++c) {
        const float one = color[k][c] - pixels.value[i][c];
        d += one * one;
      }
      if (d < nearest) nearest = d, fit.index[i] = int(k);
    }
    fit.error += pixels.weight[i] * nearest;
  }
}

using Ends = std::array<Floats, 2>;

/// Takes the fit with these ends if it is better than `best`.
bool improve(const Pixels& pixels, const Mode& mode, const std::array<Ints, 2>& end, Fit& best) {
  if (!can_hold(mode, end)) return false;
  Fit fit{&mode, end, {}, 0};
  choose_colors(pixels, fit);
  if (!(fit.error < best.error)) return false;
  best = fit;
  return true;
}

std::array<Ints, 2> quantise(const Ends& ends, int bits) {
  std::array<Ints, 2> out{};
  for (size_t e = 0; e < 2; ++e)
    for (size_t c = 0; c < 3; ++c) out[e][c] = quantise(ends[e][c], bits);
  return out;
}

/// The ends of the line through the pixels along which they vary most, at the outermost of them.
Ends outermost(const Pixels& pixels) {
  Floats mean{};
  float sum = 0;
  for (size_t i = 0; i < kPixels; ++i) {
    sum += pixels.weight[i];
    for (size_t c = 0; c < 3; ++c) mean[c] += pixels.weight[i] * pixels.value[i][c];
  }
  if (sum == 0) return {};
  for (float& m : mean) m /= sum;
  std::array<Floats, 3> covariance{};
  for (size_t i = 0; i < kPixels; ++i)
    for (size_t a = 0; a < 3; ++a)
      for (size_t b = 0; b < 3; ++b)
        covariance[a][b] +=
            pixels.weight[i] * (pixels.value[i][a] - mean[a]) * (pixels.value[i][b] - mean[b]);
  // Its largest eigenvector, by repeated products. A fixed start could lie at right angles to it.
  size_t most = 0;
  for (size_t c = 1; c < 3; ++c)
    if (covariance[c][c] > covariance[most][most]) most = c;
  Floats axis = covariance[most];
  if (axis == Floats{}) axis = {1, 1, 1};
  for (int k = 0; k < 8; ++k) {
    Floats next{};
    float largest = 0;
    for (size_t a = 0; a < 3; ++a) {
      for (size_t b = 0; b < 3; ++b) next[a] += covariance[a][b] * axis[b];
      largest = std::max(largest, std::abs(next[a]));
    }
    if (largest == 0) break;
    for (size_t a = 0; a < 3; ++a) axis[a] = next[a] / largest;
  }
  const float length2 = axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2];
  float low = 0, high = 0;
  for (size_t i = 0; i < kPixels; ++i) {
    if (pixels.weight[i] == 0) continue;
    float t = 0;
    for (size_t c = 0; c < 3; ++c) t += (pixels.value[i][c] - mean[c]) * axis[c];
    low = std::min(low, t / length2), high = std::max(high, t / length2);
  }
  Ends out{};
  for (size_t c = 0; c < 3; ++c) {
    out[0][c] = std::clamp(mean[c] + low * axis[c], 0.0f, float(kLargestBits));
    out[1][c] = std::clamp(mean[c] + high * axis[c], 0.0f, float(kLargestBits));
  }
  return out;
}

/// The ends that fit best by least squares if each pixel keeps its place between them; `old` where
/// all have the same place.
Ends least_squares(const Pixels& pixels, const Fit& fit, const Ends& old) {
  float aa = 0, ab = 0, bb = 0;
  Floats a_value{}, b_value{};
  for (size_t i = 0; i < kPixels; ++i) {
    const float b = float(kWeights[size_t(fit.index[i])]) / 64, a = 1 - b, w = pixels.weight[i];
    aa += w * a * a, ab += w * a * b, bb += w * b * b;
    for (size_t c = 0; c < 3; ++c) {
      a_value[c] += w * a * pixels.value[i][c];
      b_value[c] += w * b * pixels.value[i][c];
    }
  }
  const float determinant = aa * bb - ab * ab;
  if (!(determinant > 1e-4f)) return old;
  Ends out{};
  for (size_t c = 0; c < 3; ++c) {
    const float a = (bb * a_value[c] - ab * b_value[c]) / determinant;
    const float b = (aa * b_value[c] - ab * a_value[c]) / determinant;
    out[0][c] = std::clamp(a, 0.0f, float(kLargestBits));
    out[1][c] = std::clamp(b, 0.0f, float(kLargestBits));
  }
  return out;
}

/// Moves one number of an end by one while that helps.
void polish(const Pixels& pixels, Fit& best) {
  for (int round = 0; round < 2; ++round) {
    bool is_better = false;
    for (size_t e = 0; e < 2; ++e)
      for (size_t c = 0; c < 3; ++c)
        for (const int step : {-1, 1}) {
          std::array<Ints, 2> end = best.end;
          end[e][c] += step;
          const int most = best.mode->bits == 16 ? (int(kLargestBits) * 64 + 30) / 31
                                                 : (1 << best.mode->bits) - 1;
          if (end[e][c] < 0 || end[e][c] > most) continue;
          is_better |= improve(pixels, *best.mode, end, best);
        }
    if (!is_better) return;
  }
}

/// The best fit of all modes.
Fit fit_block(const Pixels& pixels) {
  Fit best;
  for (const Mode& mode : kModes) {
    Ends ends = outermost(pixels);
    Fit of_mode;
    for (int k = 0; k < 3; ++k) {
      improve(pixels, mode, quantise(ends, mode.bits), of_mode);
      if (!of_mode.mode) break;  // the ends are too far apart for it
      ends = least_squares(pixels, of_mode, ends);
    }
    if (!of_mode.mode) continue;
    polish(pixels, of_mode);
    if (of_mode.error < best.error) best = of_mode;
    if (best.error == 0) break;
  }
  LUXEL_CHECK(best.mode);  // the last mode holds all ends
  return best;
}

/// Bits of a block, from the lowest of the first byte on.
struct BitWriter {
  std::byte* to = nullptr;
  int at = 0;

  void put(uint32_t value, int bits) {
    for (int k = 0; k < bits; ++k, ++at)
      if (value >> k & 1) to[at / 8] |= std::byte(1 << at % 8);
  }
  /// Bits [from, end) of a value, the highest first.
  void put_reversed(uint32_t value, int from, int end) {
    for (int k = end - 1; k >= from; --k) put(value >> k & 1, 1);
  }
};

void write_block(Fit fit, std::byte* to) {
  // The highest bit of the first index is not stored: it is 0.
  if (fit.index[0] >= 8) {
    std::swap(fit.end[0], fit.end[1]);
    for (int& index : fit.index) index = 15 - index;
  }
  BitWriter out{to};
  const Mode& mode = *fit.mode;
  out.put(mode.number, 5);
  for (size_t c = 0; c < 3; ++c) out.put(uint32_t(fit.end[0][c]), 10);
  for (size_t c = 0; c < 3; ++c) {
    const int second = mode.has_differences() ? fit.end[1][c] - fit.end[0][c] : fit.end[1][c];
    out.put(uint32_t(second), mode.difference_bits);
    out.put_reversed(uint32_t(fit.end[0][c]), 10, mode.bits);
  }
  for (size_t i = 0; i < kPixels; ++i) out.put(uint32_t(fit.index[i]), i == 0 ? 3 : 4);
  LUXEL_CHECK(out.at == 128);
}

Pixels pixels_of(const HalfImage& image, int x0, int y0) {
  Pixels out;
  for (int i = 0; i < kPixels; ++i) {
    const int x = std::min(x0 + i % kSide, image.width - 1);
    const int y = std::min(y0 + i / kSide, image.height - 1);
    const uint16_t* pixel =
        image.data.data() + (size_t(y) * size_t(image.width) + size_t(x)) * size_t(image.channels);
    bool is_black = true;
    for (size_t c = 0; c < 3; ++c) {
      const uint16_t bits = pixel[c] & 0x8000 ? 0 : std::min(pixel[c], kLargestBits);
      out.value[size_t(i)][c] = float(bits);
      is_black = is_black && bits == 0;
    }
    out.weight[size_t(i)] = is_black && image.channels == 4 && pixel[3] == 0 ? 0.0f : 1.0f;
  }
  return out;
}

}  // namespace

std::vector<std::byte> encode_bc6h(const HalfImage& image) {
  LUXEL_CHECK(image.width > 0 && image.height > 0 && image.channels >= 3);
  const size_t columns = size_t(image.width + kSide - 1) / kSide;
  const size_t rows = size_t(image.height + kSide - 1) / kSide;
  std::vector<std::byte> out(columns * rows * kPixels);
  parallel_for(rows, 1, [&](size_t begin, size_t end) {
    for (size_t row = begin; row < end; ++row)
      for (size_t column = 0; column < columns; ++column)
        write_block(fit_block(pixels_of(image, int(column) * kSide, int(row) * kSide)),
                    out.data() + (row * columns + column) * kPixels);
  });
  return out;
}

namespace {

/// Numbers of a file, the lowest byte first.
struct FileWriter {
  std::vector<std::byte> bytes;

  void u8(uint32_t value) { bytes.push_back(std::byte(value)); }
  void u16(uint32_t value) { u8(value), u8(value >> 8); }
  void u32(uint32_t value) { u16(value), u16(value >> 16); }
  void u64(uint64_t value) { u32(uint32_t(value)), u32(uint32_t(value >> 32)); }
  void text(std::string_view text) {
    for (const char c : text) u8(uint8_t(c));
  }
  void align(size_t to) {
    while (bytes.size() % to != 0) u8(0);
  }
  void set_u32(size_t at, uint32_t value) {
    for (size_t k = 0; k < 4; ++k) bytes[at + k] = std::byte(value >> (8 * k));
  }
};

/// Describes the blocks in the words of the Khronos data format [DataFormat, section 5]: a basic
/// descriptor with one sample.
void put_data_format(FileWriter& out) {
  constexpr uint32_t kBc6h = 133, kBt709 = 1, kLinear = 1, kFloat = 0x80;
  out.u32(44);              // bytes of all descriptors, with this number
  out.u32(0);               // by Khronos, basic
  out.u16(2), out.u16(40);  // version, bytes of the descriptor
  out.u8(kBc6h), out.u8(kBt709), out.u8(kLinear), out.u8(0);
  out.u8(kSide - 1), out.u8(kSide - 1), out.u8(0), out.u8(0);
  out.u8(kPixels), out.u8(0), out.u16(0), out.u32(0);  // bytes of each plane
  out.u16(0), out.u8(127), out.u8(kFloat);             // first bit, bits - 1, unsigned floats
  out.u32(0);                                          // where in the block
  out.u32(0), out.u32(0x3f800000);                     // from 0 to 1
}

void put_pair(FileWriter& out, std::string_view key, std::string_view value) {
  out.u32(uint32_t(key.size() + value.size() + 2));
  out.text(key), out.u8(0), out.text(value), out.u8(0);
  out.align(4);
}

}  // namespace

std::vector<std::byte> ktx2_of_bc6h(const HalfImage& image) {
  constexpr uint32_t kVkFormatBc6hUfloat = 143;
  const std::vector<std::byte> blocks = encode_bc6h(image);
  FileWriter out;
  for (const uint8_t byte :
       {0xab, 0x4b, 0x54, 0x58, 0x20, 0x32, 0x30, 0xbb, 0x0d, 0x0a, 0x1a, 0x0a})
    out.u8(byte);
  out.u32(kVkFormatBc6hUfloat), out.u32(1);
  out.u32(uint32_t(image.width)), out.u32(uint32_t(image.height)), out.u32(0);
  out.u32(0), out.u32(1), out.u32(1), out.u32(0);  // no layers; a face; a level; as it is
  const size_t index = out.bytes.size();
  for (int k = 0; k < 4; ++k) out.u32(0);  // set below: where descriptors and pairs are
  out.u64(0), out.u64(0);                  // nothing is shared by levels
  const size_t level = out.bytes.size();
  out.u64(0), out.u64(blocks.size()), out.u64(blocks.size());
  out.set_u32(index, uint32_t(out.bytes.size()));
  put_data_format(out);
  out.set_u32(index + 4, uint32_t(out.bytes.size()) - 104);
  const size_t pairs = out.bytes.size();
  put_pair(out, "KTXorientation", "rd");  // x to the right, y down
  put_pair(out, "KTXwriter", "luxel");
  out.set_u32(index + 8, uint32_t(pairs));
  out.set_u32(index + 12, uint32_t(out.bytes.size() - pairs));
  out.align(kPixels);
  out.set_u32(level, uint32_t(out.bytes.size()));
  out.bytes.insert(out.bytes.end(), blocks.begin(), blocks.end());
  return std::move(out.bytes);
}

}  // namespace luxel::image
