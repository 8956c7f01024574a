#include "luxel/atlas/strip.h"

#include <algorithm>
#include <bit>

namespace luxel::atlas {
namespace {

constexpr uint64_t kFull = ~uint64_t(0);
/// Rows that a band stands for. They change how fast a free place is found, not which.
constexpr int kBand = 8;
/// Lower shapes are found as fast without bands, which cost time to keep.
constexpr int kBandShape = 32;

int log2_floor(int n) { return int(std::bit_width(unsigned(n))) - 1; }

/// The leftmost free column for a shape with its top at row y, or -1.
int free_column(const BitRows& rows, const Shape& shape, int y, std::vector<uint64_t>& blocked) {
  // The longest runs come first: one that is too full refuses the row before columns are looked at.
  constexpr size_t kQuick = 24;
  for (size_t r = 0; r < std::min(kQuick, shape.runs.size()); ++r)
    if (rows.too_full(y + shape.runs[r].row, shape.runs[r].columns)) return -1;
  std::fill(blocked.begin(), blocked.end(), 0);
  for (const Shape::Run& run : shape.runs) {
    rows.block(y + run.row, run.columns, blocked);
    if (std::all_of(blocked.begin(), blocked.end(), [](uint64_t w) { return w == kFull; }))
      return -1;
  }
  for (size_t w = 0; w < blocked.size(); ++w)
    if (blocked[w] != kFull) return int(64 * w) + std::countr_one(blocked[w]);
  return -1;
}

}  // namespace

Shape make_shape(const Mask& mask) {
  Shape shape{mask.width, mask.height, {}};
  for (int j = 0; j < mask.height; ++j)
    for (const Span run : mask.rows[size_t(j)]) shape.runs.push_back({j, run});
  std::stable_sort(shape.runs.begin(), shape.runs.end(), [](const auto& a, const auto& b) {
    return a.columns.end - a.columns.begin > b.columns.end - b.columns.begin;
  });
  return shape;
}

BitRows::BitRows(int side) : words_((size_t(side) + 63) / 64), count_(side), levels_(1) {
  while (levels_ < 7 && (1 << levels_) <= side) ++levels_;
  bits_.assign(size_t(count_) * size_t(levels_) * words_, 0);
  free_level_.assign(size_t(count_), levels_ - 1);
  if (side % 64 != 0)
    for (int y = 0; y < count_; ++y) row(y, 0)[words_ - 1] = kFull << (side % 64);
  for (int y = 0; y < count_; ++y) refresh(y);
}

int BitRows::level_of(Span columns) const {
  return std::min(levels_ - 1, log2_floor(columns.end - columns.begin));
}

uint64_t* BitRows::row(int y, int level) {
  return &bits_[(size_t(y) * size_t(levels_) + size_t(level)) * words_];
}
const uint64_t* BitRows::row(int y, int level) const {
  return &bits_[(size_t(y) * size_t(levels_) + size_t(level)) * words_];
}

void BitRows::set(int y, Span columns) {
  uint64_t* bits = row(y, 0);
  for (int x = columns.begin; x < columns.end;) {
    const int end = std::min(columns.end, (x / 64 + 1) * 64);
    const uint64_t ones = end - x == 64 ? kFull : (uint64_t(1) << (end - x)) - 1;
    bits[x / 64] |= ones << (x % 64);
    x = end;
  }
}

void BitRows::intersect(const BitRows& rows, int y, int row_count, BitRows& all) {
  uint64_t* bits = all.row(y, 0);
  std::copy_n(rows.row(y, 0), rows.words_, bits);
  for (int i = y + 1; i < std::min(y + row_count, rows.count_); ++i)
    for (size_t w = 0; w < rows.words_; ++w) bits[w] &= rows.row(i, 0)[w];
  all.refresh(y);
}

void BitRows::refresh(int y) {
  free_level_[size_t(y)] = -1;
  for (int k = 0; k < levels_; ++k) {
    uint64_t* bits = row(y, k);
    if (k > 0) {
      const uint64_t* below = row(y, k - 1);
      const int shift = 1 << (k - 1);
      for (size_t w = 0; w < words_; ++w) {
        const uint64_t right = w + 1 < words_ ? below[w + 1] : kFull;
        bits[w] = below[w] | below[w] >> shift | right << (64 - shift);
      }
    }
    for (size_t w = 0; w < words_; ++w)
      if (bits[w] != kFull) free_level_[size_t(y)] = k;
  }
}

void BitRows::block(int y, Span columns, std::vector<uint64_t>& blocked) const {
  const int level = level_of(columns);
  const uint64_t* bits = row(y, level);
  const int step = 1 << level;
  for (int at = columns.begin; at + step < columns.end; at += step) add_shifted(bits, at, blocked);
  add_shifted(bits, columns.end - step, blocked);
}

void BitRows::add_shifted(const uint64_t* bits, int offset, std::vector<uint64_t>& blocked) const {
  const size_t skip = std::min(words_, size_t(offset) / 64);
  const int shift = offset % 64;
  const size_t inside = words_ - skip;  // words of `blocked` whose source starts in the row
  if (shift == 0) {
    for (size_t w = 0; w < inside; ++w) blocked[w] |= bits[w + skip];
  } else {
    for (size_t w = 0; w + 1 < inside; ++w)
      blocked[w] |= bits[w + skip] >> shift | bits[w + skip + 1] << (64 - shift);
    if (inside > 0) blocked[inside - 1] |= bits[words_ - 1] >> shift | kFull << (64 - shift);
  }
  for (size_t w = inside; w < words_; ++w) blocked[w] = kFull;
}

void Strip::take_with_gutter(const Mask& mask, ChartPosition place, int gutter) {
  const int top = std::max(0, place.y - gutter);
  const int bottom = std::min(side(), place.y + mask.height + gutter);
  for (int y = top; y < bottom; ++y) {
    const int first = std::max(0, y - place.y - gutter);
    const int last = std::min(mask.height - 1, y - place.y + gutter);
    for (int j = first; j <= last; ++j)
      for (const Span run : mask.rows[size_t(j)])
        taken_.set(y, {std::max(0, place.x + run.begin - gutter),
                       std::min(side(), place.x + run.end + gutter)});
    taken_.refresh(y);
  }
  // Bands that know of fewer texels only say no less often.
  if (mask.height < kBandShape) return;
  for (int y = std::max(0, top - kBand + 1); y < bottom; ++y)
    BitRows::intersect(taken_, y, kBand, bands_);
}

ChartPosition Strip::topmost(const Shape& shape, int first, int last) const {
  std::vector<uint64_t> blocked(blocked_words_);
  last = std::min(last, side() - shape.height);
  for (int y = first; y <= last;) {
    const int band_end = std::min(y + kBand, last + 1);
    if (shape.height >= kBandShape && free_column(bands_, shape, y, blocked) < 0) {
      y = band_end;
      continue;
    }
    for (; y < band_end; ++y)
      if (const int x = free_column(taken_, shape, y, blocked); x >= 0) return {x, y};
  }
  return {-1, -1};
}

}  // namespace luxel::atlas
