// From the matrix to blocks.
#include <stb/stb_dxt.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>

#include "luxel/base/check.h"
#include "luxel/base/parallel.h"
#include "luxel/solve/matrix/bc1.h"
#include "luxel/solve/matrix/bc1_block.h"
#include "luxel/solve/matrix/bc1_picture.h"
#include "luxel/solve/matrix/half.h"
#include "luxel/solve/matrix/reorder.h"

namespace luxel::matrix {
namespace {

/// Rows that a task takes.
constexpr size_t kMakeRows = 16;

/// Distances between columns are the same whatever the order of the rows, so the second order does
/// not wait for the first.
void choose_order(const Picture& picture, Bc1Params::Order order, const Progress& progress,
                  Bc1& out) {
  const size_t n = picture.n;
  out.row.resize(n), out.column.resize(n);
  std::iota(out.row.begin(), out.row.end(), 0u);
  std::iota(out.column.begin(), out.column.end(), 0u);
  if (order == Bc1Params::Order::as_is || n == 0) return;
  out.row =
      greedy_order(project({picture.rgba.data(), n, n, n, 1}, progress), kProjected, progress);
  if (order == Bc1Params::Order::rows) return;
  out.column =
      greedy_order(project({picture.rgba.data(), n, n, 1, n}, progress), kProjected, progress);
}

/// 16 entries of a block. Beyond the last row and column the last is repeated.
using Pixels = std::array<uint8_t, 64>;

Pixels pixels_of(const Picture& picture, const Bc1& order, size_t row, size_t column) {
  Pixels out;
  for (size_t k = 0; k < 16; ++k) {
    const size_t r = std::min(row + k / 4, picture.n - 1);
    const size_t c = std::min(column + k % 4, picture.n - 1);
    std::memcpy(out.data() + 4 * k, picture.at(order.row[r], order.column[c]), 4);
  }
  return out;
}

/// Kept entries take the mean of the others of their block, if there are any.
void fill_holes(Pixels& pixels) {
  for (size_t c = 0; c < 3; ++c) {
    uint32_t sum = 0, count = 0;
    for (size_t k = 0; k < 16; ++k)
      if (pixels[4 * k + 3] != 0) sum += pixels[4 * k + c], ++count;
    for (size_t k = 0; k < 16 && count > 0; ++k)
      if (pixels[4 * k + 3] == 0) pixels[4 * k + c] = uint8_t((sum + count / 2) / count);
  }
}

uint64_t encode(Pixels& pixels) {
  for (size_t k = 0; k < 16; ++k) pixels[4 * k + 3] = 255;
  std::array<uint8_t, 8> bytes;
  stb_compress_dxt_block(bytes.data(), pixels.data(), 0, STB_DXT_HIGHQUAL);
  uint64_t block = 0;
  for (size_t k = 0; k < 8; ++k) block |= uint64_t(bytes[k]) << (8 * k);
  // Ends that are alike mean the other mode, where some index is black: not the first.
  return (block & 0xffff) == (block >> 16 & 0xffff) ? block & 0xffffffff : block;
}

/// The sums of entries that blocks so far lack, channel by channel, as parts of the maxima. A flat
/// block errs by up to a whole step of 5 bits in all entries, and so do its neighbours, which are
/// alike; each makes up for what those before it lost, as in error diffusion.
struct Carry {
  std::array<float, 256> value;  ///< of a byte
  float log_range = 0;
  std::array<float, 3> lacking{};

  /// Raises or lowers what is to be encoded, at most thrice: a block that owes more than it holds
  /// must not turn white, and what is left is owed on.
  void lift(Pixels& pixels) const {
    for (size_t c = 0; c < 3; ++c) {
      float sum = 0;
      for (size_t k = 0; k < 16; ++k)
        if (pixels[4 * k + 3] != 0) sum += value[pixels[4 * k + c]];
      if (!(sum > 0)) continue;
      const float factor = std::clamp(1 + lacking[c] / sum, 1.0f / 3, 3.0f);
      const long step = std::lround(std::log(factor) / log_range * 255);
      for (size_t k = 0; k < 16; ++k)
        if (uint8_t& byte = pixels[4 * k + c]; byte > 0)
          byte = uint8_t(std::clamp(byte + step, 1l, 255l));
    }
  }
  void count(const Pixels& wanted, uint64_t block) {
    const std::array<BlockColor, 4> colors = block_colors(block);
    for (size_t k = 0; k < 16; ++k)
      for (size_t c = 0; c < 3 && wanted[4 * k + 3] != 0; ++c)
        lacking[c] += value[wanted[4 * k + c]] - value[colors[block_index(block, k / 4, k % 4)][c]];
  }
};

void encode_block_row(const Picture& picture, const Bc1Params& params, size_t block_row, Bc1& out) {
  const size_t wide = out.blocks_per_row();
  Carry carry{byte_values(params.log_range), params.log_range, {}};
  for (size_t c = 0; c < wide; ++c) {
    const Pixels wanted = pixels_of(picture, out, 4 * block_row, 4 * c);
    Pixels pixels = wanted;
    if (params.keep_sums) carry.lift(pixels);
    if (params.hole == Bc1Params::Hole::neighbours) fill_holes(pixels);
    out.blocks[block_row * wide + c] = encode(pixels);
    if (params.keep_sums) carry.count(wanted, out.blocks[block_row * wide + c]);
  }
}

Status encode_blocks(const Picture& picture, const Bc1Params& params, Bc1& out,
                     Progress& progress) {
  const size_t wide = out.blocks_per_row();
  out.blocks.resize(wide * wide);
  parallel_for(wide, 4, [&](size_t begin, size_t end) {
    if (progress.cancelled()) return;
    for (size_t r = begin; r < end; ++r) encode_block_row(picture, params, r, out);
    progress.advance(end - begin);
  });
  return stopped(progress);
}

/// By how much the decoded rest of one row is to be scaled: even light is to arrive as it did.
void scale_row(const ColourMatrix& matrix, const Picture& picture, const Bc1Params& params,
               std::span<const Rgb> mean, size_t place, Bc1& out) {
  const size_t n = matrix.n, i = out.row[place];
  out.row_scale[place] = {1, 1, 1};
  std::vector<Rgb> rest(n);
  decode_row(out, place, rest);
  std::array<float, 3> scale = picture.largest;
  for (size_t c = 0; c < 3 && params.keep_sums; ++c) {
    double want = 0, got = 0;
    for (size_t j = 0; j < n; ++j) {
      const bool kept = picture.is_kept(i, j);
      if (!kept) want += double(matrix.channel[c][i * n + j]) * double(mean[j][int(c)]);
      if (!kept || params.hole == Bc1Params::Hole::zero) got += double(rest[j][int(c)]);
    }
    // A row of which 8 bits hold next to nothing must not grow without bounds.
    if (got > 0 && scale[c] > 0) scale[c] *= std::clamp(float(want / got) / scale[c], 0.25f, 4.0f);
  }
  out.row_scale[place] = {scale[0], scale[1], scale[2]};
}

/// Where the columns lie.
std::vector<uint32_t> inverse(std::span<const uint32_t> order) {
  std::vector<uint32_t> out(order.size());
  for (uint32_t place = 0; place < order.size(); ++place) out[order[place]] = place;
  return out;
}

/// Scales the rest, and keeps what is to be kept: the entry, or what the rest lacks of it, in units
/// of the columns' means as `matrix` is.
void keep(const ColourMatrix& matrix, const Picture& picture, const KeptColumns& kept,
          const Bc1Params& params, std::span<const Rgb> mean, const Progress& progress, Bc1& out) {
  const size_t n = matrix.n;
  out.row_scale.assign(n, {});
  for (size_t c = 0; c < 3; ++c)
    for (const float entry : matrix.channel[c])
      out.kept_unit[c] = std::max(out.kept_unit[c], entry);
  // Halves reach from 6e-8 to 65,504; the rest is at most 4 times the largest, 32,768 in this unit.
  for (float& unit : out.kept_unit) unit = unit > 0 ? unit / 8192 : 1.0f;
  // Nothing is kept yet, so that rows are decoded without it.
  out.first_kept.assign(n + 1, 0);
  std::vector<uint32_t> first(n + 1);
  for (size_t place = 0; place < n; ++place)
    first[place + 1] = first[place] + uint32_t(kept[out.row[place]].size());
  std::vector<Bc1::Kept> entries(first.back());
  const std::vector<uint32_t> place_of = inverse(out.column);
  parallel_for(n, kMakeRows, [&](size_t begin, size_t end) {
    std::vector<Rgb> rest(n);
    for (size_t place = begin; place < end && !progress.cancelled(); ++place) {
      scale_row(matrix, picture, params, mean, place, out);
      if (params.hole == Bc1Params::Hole::neighbours) decode_row(out, place, rest);
      const size_t row = out.row[place];
      Bc1::Kept* entry = entries.data() + first[place];
      for (const uint32_t j : kept[row]) {
        for (size_t c = 0; c < 3; ++c) {
          const float there = rest[j][int(c)] / mean[j][int(c)];
          const float lacking = matrix.channel[c][row * n + j] - there;
          entry->value[c] = half_from_float(lacking / out.kept_unit[c]);
        }
        entry++->place = uint16_t(place_of[j]);
      }
      std::sort(entries.data() + first[place], entry,
                [](const Bc1::Kept& a, const Bc1::Kept& b) { return a.place < b.place; });
    }
  });
  out.first_kept = std::move(first), out.kept = std::move(entries);
}

}  // namespace

Bc1Params paper_params() {
  Bc1Params params;
  params.log_range = 25, params.hole = Bc1Params::Hole::zero;
  params.keep_sums = params.even_columns = false;
  return params;
}

Result<Bc1> make_bc1(ColourMatrix matrix, Bc1Params params, Progress& progress) {
  const size_t n = matrix.n;
  if (n > kMaxBc1Patches)
    return fail(ErrorCode::bad_setting, "bc1 holds up to {} patches, not {}: ask for fewer",
                kMaxBc1Patches, n);
  if (!(params.kept >= 0 && params.kept < 1))
    return fail(ErrorCode::bad_setting, "the share of entries kept is {}; from 0 to below 1",
                params.kept);
  if (!(params.log_range >= 0 && params.log_range <= 80))
    return fail(ErrorCode::bad_setting, "the logarithms' range is {}; 0 (to be fitted) to 80",
                params.log_range);
  Bc1 out;
  out.n = uint32_t(n);
  progress.begin("bc1", out.blocks_per_row());
  // Columns of even size; the largest entries, and a picture of the rest.
  const std::vector<Rgb> mean =
      params.even_columns ? even_columns(matrix) : std::vector<Rgb>(n, Rgb{1, 1, 1});
  const KeptColumns kept = choose_kept(matrix, params.kept, progress);
  const Picture picture = picture_of(matrix, kept, params, progress);
  LUXEL_TRY_STATUS(stopped(progress));
  // Rows and columns in order, then blocks.
  out.log_range = params.log_range;
  choose_order(picture, params.order, progress, out);
  LUXEL_TRY_STATUS(encode_blocks(picture, params, out, progress));
  // Scales that keep sums, and what is kept of the largest entries.
  for (const uint32_t j : out.column) out.column_scale.push_back(mean[j]);
  keep(matrix, picture, kept, params, mean, progress, out);
  LUXEL_TRY_STATUS(stopped(progress));
  return out;
}

}  // namespace luxel::matrix
