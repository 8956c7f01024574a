// From the matrix to blocks.
#include <stb/stb_dxt.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <numeric>

#include "base/check.h"
#include "base/parallel.h"
#include "solve/matrix/bc1.h"
#include "solve/matrix/bc1_block.h"
#include "solve/matrix/half.h"
#include "solve/matrix/reorder.h"

namespace luxel::matrix {
namespace {

/// Rows that a task takes.
constexpr size_t kRows = 16;

/// The columns of each row that are kept, ascending.
using KeptColumns = std::vector<std::vector<uint32_t>>;

/// The largest `share` of every row and channel; of equal ones the first.
KeptColumns choose_kept(const ColourMatrix& matrix, float share) {
  const size_t n = matrix.n;
  const auto count = std::ptrdiff_t(std::ceil(double(share) * double(n)));
  KeptColumns out(n);
  parallel_for(n, kRows, [&](size_t begin, size_t end) {
    std::vector<uint32_t> order(n);
    for (size_t i = begin; i < end; ++i) {
      for (size_t c = 0; c < 3; ++c) {
        const float* entry = matrix.channel[c].data() + i * n;
        std::iota(order.begin(), order.end(), 0u);
        std::nth_element(order.begin(), order.begin() + count, order.end(),
                         [&](uint32_t a, uint32_t b) {
                           return entry[a] != entry[b] ? entry[a] > entry[b] : a < b;
                         });
        out[i].insert(out[i].end(), order.begin(), order.begin() + count);
      }
      std::sort(out[i].begin(), out[i].end());
      out[i].erase(std::unique(out[i].begin(), out[i].end()), out[i].end());
    }
  });
  return out;
}

/// The rest in 8 bits: RGBA, row by row. A is 0 where the entry is kept, else 255.
struct Picture {
  size_t n = 0;
  std::vector<uint8_t> rgba;
  std::array<float, 3> largest{};  ///< per channel, of the rest

  uint8_t* at(size_t row, size_t column) { return rgba.data() + 4 * (row * n + column); }
  const uint8_t* at(size_t row, size_t column) const {
    return rgba.data() + 4 * (row * n + column);
  }
  bool is_kept(size_t row, size_t column) const { return at(row, column)[3] == 0; }
};

uint8_t byte_of(float value, float largest, float log_range) {
  if (!(value > 0)) return 0;
  const float level = (std::log(value / largest) / log_range + 1) * 255;
  return uint8_t(std::clamp(std::lround(level), 0l, 255l));
}

/// The largest entry of every channel that is not kept.
std::array<float, 3> largest_of_rest(const ColourMatrix& matrix, const Picture& picture) {
  const size_t n = matrix.n;
  std::vector<Rgb> of_row(n);
  parallel_for(n, kRows, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      std::array<float, 3> largest{};
      for (size_t c = 0; c < 3; ++c)
        for (size_t j = 0; j < n; ++j)
          if (!picture.is_kept(i, j))
            largest[c] = std::max(largest[c], matrix.channel[c][i * n + j]);
      of_row[i] = {largest[0], largest[1], largest[2]};
    }
  });
  Rgb all{};
  for (const Rgb& row : of_row) all = max(all, row);
  return {all.x, all.y, all.z};
}

Picture picture_of(const ColourMatrix& matrix, const KeptColumns& kept, const Bc1Params& params) {
  const size_t n = matrix.n;
  Picture out{n, std::vector<uint8_t>(4 * n * n, 255), {}};
  for (size_t i = 0; i < n; ++i)
    for (const uint32_t j : kept[i]) out.at(i, j)[3] = 0;
  out.largest = largest_of_rest(matrix, out);
  parallel_for(n, kRows, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i)
      for (size_t j = 0; j < n; ++j)
        for (size_t c = 0; c < 3; ++c)
          out.at(i, j)[c] =
              params.hole == Bc1Params::Hole::zero && out.is_kept(i, j)
                  ? uint8_t(0)
                  : byte_of(matrix.channel[c][i * n + j], out.largest[c], params.log_range);
  });
  return out;
}

/// Distances between columns are the same whatever the order of the rows, so the second order does
/// not wait for the first.
void choose_order(const Picture& picture, Bc1Params::Order order, Bc1& out) {
  const size_t n = picture.n;
  out.row.resize(n), out.column.resize(n);
  std::iota(out.row.begin(), out.row.end(), 0u);
  std::iota(out.column.begin(), out.column.end(), 0u);
  if (order == Bc1Params::Order::as_is || n == 0) return;
  out.row = greedy_order(project({picture.rgba.data(), n, n, n, 1}), kProjected);
  if (order == Bc1Params::Order::rows) return;
  out.column = greedy_order(project({picture.rgba.data(), n, n, 1, n}), kProjected);
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

Status encode_blocks(const Picture& picture, Bc1Params::Hole hole, Bc1& out, Progress& progress) {
  const size_t wide = out.blocks_per_row();
  out.blocks.resize(wide * wide);
  std::atomic<bool> cancelled = false;
  parallel_for(wide, 4, [&](size_t begin, size_t end) {
    if (progress.cancelled()) cancelled = true;
    if (cancelled) return;
    for (size_t r = begin; r < end; ++r)
      for (size_t c = 0; c < wide; ++c) {
        Pixels pixels = pixels_of(picture, out, 4 * r, 4 * c);
        if (hole == Bc1Params::Hole::neighbours) fill_holes(pixels);
        out.blocks[r * wide + c] = encode(pixels);
      }
    progress.advance(end - begin);
  });
  if (cancelled) return fail(ErrorCode::cancelled, "cancelled");
  return {};
}

/// By how much the decoded rest of one row is to be scaled, and with it decoded.
void scale_row(const ColourMatrix& matrix, const Picture& picture, const Bc1Params& params,
               size_t place, Bc1& out) {
  const size_t n = matrix.n, i = out.row[place];
  out.row_scale[place] = {1, 1, 1};
  std::vector<Rgb> rest(n);
  decode_row(out, place, rest);
  std::array<float, 3> scale = picture.largest;
  for (size_t c = 0; c < 3 && params.keep_row_sums; ++c) {
    double want = 0, got = 0;
    for (size_t j = 0; j < n; ++j) {
      const bool kept = picture.is_kept(i, j);
      if (!kept) want += double(matrix.channel[c][i * n + j]);
      if (!kept || params.hole == Bc1Params::Hole::zero) got += double(rest[j][int(c)]);
    }
    if (got > 0) scale[c] = float(want / got);
  }
  out.row_scale[place] = {scale[0], scale[1], scale[2]};
}

/// Where the columns lie.
std::vector<uint32_t> inverse(std::span<const uint32_t> order) {
  std::vector<uint32_t> out(order.size());
  for (uint32_t place = 0; place < order.size(); ++place) out[order[place]] = place;
  return out;
}

/// Scales the rest, and keeps what is to be kept: the entry, or what the rest lacks of it.
void keep(const ColourMatrix& matrix, const Picture& picture, const KeptColumns& kept,
          const Bc1Params& params, Bc1& out) {
  const size_t n = matrix.n;
  out.row_scale.assign(n, {});
  for (size_t c = 0; c < 3; ++c)
    for (const float entry : matrix.channel[c])
      out.kept_unit[c] = std::max(out.kept_unit[c], entry);
  // Halves reach from 6e-8 to 65,504, and a difference is at most some times the entry.
  for (float& unit : out.kept_unit) unit = unit > 0 ? unit / 8192 : 1.0f;
  // Nothing is kept yet, so that rows are decoded without it.
  out.first_kept.assign(n + 1, 0);
  std::vector<uint32_t> first(n + 1);
  for (size_t place = 0; place < n; ++place)
    first[place + 1] = first[place] + uint32_t(kept[out.row[place]].size());
  std::vector<Bc1::Kept> entries(first.back());
  const std::vector<uint32_t> place_of = inverse(out.column);
  parallel_for(n, kRows, [&](size_t begin, size_t end) {
    std::vector<Rgb> rest(n);
    for (size_t place = begin; place < end; ++place) {
      scale_row(matrix, picture, params, place, out);
      if (params.hole == Bc1Params::Hole::neighbours) decode_row(out, place, rest);
      const size_t row = out.row[place];
      Bc1::Kept* entry = entries.data() + first[place];
      for (const uint32_t j : kept[row]) {
        for (size_t c = 0; c < 3; ++c) {
          const float lacking = matrix.channel[c][row * n + j] - rest[j][int(c)];
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

Result<Bc1> make_bc1(const ColourMatrix& matrix, const Bc1Params& params, Progress& progress) {
  const size_t n = matrix.n;
  if (n > kMaxBc1Patches)
    return fail(ErrorCode::bad_setting, "bc1 holds up to {} patches, not {}: ask for fewer",
                kMaxBc1Patches, n);
  if (!(params.kept >= 0 && params.kept < 1))
    return fail(ErrorCode::bad_setting, "the share of entries kept is {}; from 0 to below 1",
                params.kept);
  if (!(params.log_range > 0 && params.log_range <= 80))
    return fail(ErrorCode::bad_setting, "the logarithms' range is {}; above 0, up to 80",
                params.log_range);
  Bc1 out;
  out.n = uint32_t(n), out.log_range = params.log_range;
  progress.begin("bc1", out.blocks_per_row());
  const KeptColumns kept = choose_kept(matrix, params.kept);
  const Picture picture = picture_of(matrix, kept, params);
  if (progress.cancelled()) return fail(ErrorCode::cancelled, "cancelled");
  choose_order(picture, params.order, out);
  LUXEL_TRY_STATUS(encode_blocks(picture, params.hole, out, progress));
  keep(matrix, picture, kept, params, out);
  return out;
}

}  // namespace luxel::matrix
