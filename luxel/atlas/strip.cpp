#include "luxel/atlas/strip.h"

#include <algorithm>
#include <bit>
#include <span>

namespace luxel::atlas {
namespace {

constexpr uint64_t kFull = ~uint64_t(0);
/// Rows that a band stands for. They change how fast a free place is found, not which.
constexpr int kBand = 8;
/// Lower shapes are found as fast without bands, which cost time to keep.
constexpr int kBandShape = 32;

/// Visits the numbers below a count, each far from those just before it: in the order of their
/// reversed bits.
template <class Visit>
void for_each_spread(size_t count, const Visit& visit) {
  const int bits = int(std::bit_width(count));
  for (size_t k = 0; k < size_t(1) << bits; ++k) {
    size_t turned = 0;
    for (int i = 0; i < bits; ++i) turned |= (k >> i & 1) << (bits - 1 - i);
    if (turned < count) visit(turned);
  }
}

/// How many bits the longest run of clear bits has.
int longest_clear_run(std::span<const uint64_t> bits) {
  int longest = 0, run = 0;  // `run`: those that end where a word begins
  for (const uint64_t word : bits) {
    if (word == 0) {
      run += 64;
      continue;
    }
    longest = std::max(longest, run + std::countr_zero(word));
    run = std::countl_zero(word);
    // Whether a run within the word is longer.
    uint64_t begins = ~word;  // where at least `have` clear bits begin
    for (int have = 1; begins != 0 && have <= longest;) {
      const int step = std::min(have, longest + 1 - have);
      begins &= begins >> step, have += step;
    }
    for (; begins != 0; begins &= begins >> 1) ++longest;
  }
  return std::max(longest, run);
}

/// The leftmost free column for a shape with its top at row y, or -1.
int free_column(const BitRows& rows, const Shape& shape, int y, std::vector<uint64_t>& blocked) {
  // Long runs come first: one that is too full refuses the row before columns are looked at.
  constexpr size_t kQuick = 24;
  for (size_t r = 0; r < std::min(kQuick, shape.runs.size()); ++r)
    if (rows.too_full(y + shape.runs[r].row, shape.runs[r].columns)) return -1;
  // The first leaves few words of columns, of which each is tested until it is full.
  std::fill(blocked.begin(), blocked.end(), 0);
  if (!shape.runs.empty()) rows.block(y + shape.runs[0].row, shape.runs[0].columns, blocked);
  for (size_t w = 0; w < blocked.size(); ++w) {
    uint64_t word = blocked[w];
    for (size_t r = 1; r < shape.runs.size() && word != kFull; ++r)
      word |= rows.blocked_word(y + shape.runs[r].row, shape.runs[r].columns, w);
    if (word != kFull) return int(64 * w) + std::countr_one(word);
  }
  return -1;
}

}  // namespace

Shape make_shape(const Mask& mask) {
  std::vector<RowRun> by_row;
  double sum_of_rows = 0;
  int longest = 0;
  for (int j = 0; j < mask.height; ++j)
    for (const Span run : mask.row(j)) {
      const int length = run.end - run.begin;
      by_row.push_back({j, run});
      sum_of_rows += double(j) * length;
      longest = std::max(longest, length);
    }
  Shape shape{
      mask.width, mask.height, sum_of_rows / double(std::max<uint64_t>(1, mask.texels)), {}};
  shape.runs.reserve(by_row.size());
  // Long runs fail soonest, and neighbouring rows are much alike: each run lies far from those
  // before it.
  for (const bool is_long : {true, false})
    for_each_spread(by_row.size(), [&](size_t r) {
      const Span run = by_row[r].columns;
      if ((2 * (run.end - run.begin) >= longest) == is_long) shape.runs.push_back(by_row[r]);
    });
  return shape;
}

BitRows::BitRows(int side) : words_((size_t(side) + 63) / 64), count_(side), levels_(1) {
  while (levels_ < 7 && (1 << levels_) <= side) ++levels_;
  bits_.assign(size_t(count_) * size_t(levels_) * words_, 0);
  longest_clear_.resize(size_t(count_));
  if (side % 64 != 0)
    for (int y = 0; y < count_; ++y) row(y, 0)[words_ - 1] = kFull << (side % 64);
  for (int y = 0; y < count_; ++y) refresh(y, {0, side});
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

void BitRows::intersect(const BitRows& rows, int y, int row_count, Span changed, BitRows& all) {
  const auto [first, last] = rows.words_of(changed);
  uint64_t* bits = all.row(y, 0);
  std::copy(rows.row(y, 0) + first, rows.row(y, 0) + last, bits + first);
  for (int i = y + 1; i < std::min(y + row_count, rows.count_); ++i)
    for (size_t w = first; w < last; ++w) bits[w] &= rows.row(i, 0)[w];
  all.refresh(y, changed);
}

void BitRows::refresh(int y, Span changed) {
  // A level's bits look at no more than 63 columns to the right of their own.
  auto [first, last] = words_of(changed);
  if (first > 0) --first;
  for (int k = 1; k < levels_; ++k) {
    uint64_t* bits = row(y, k);
    const uint64_t* below = row(y, k - 1);
    const int shift = 1 << (k - 1);
    for (size_t w = first; w < last; ++w) {
      const uint64_t right = w + 1 < words_ ? below[w + 1] : kFull;
      bits[w] = below[w] | below[w] >> shift | right << (64 - shift);
    }
  }
  longest_clear_[size_t(y)] = longest_clear_run({row(y, 0), words_});
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

void Strip::take(const Mask& mask, Place at) {
  const int top = std::max(0, at.y), bottom = std::min(side(), at.y + mask.height);
  const Span changed{std::max(0, at.x), std::min(side(), at.x + mask.width)};
  for (int y = top; y < bottom; ++y) {
    for (const Span run : mask.row(y - at.y))
      taken_.set(y, {std::max(0, at.x + run.begin), std::min(side(), at.x + run.end)});
    taken_.refresh(y, changed);
  }
  // Bands that know of fewer texels only say no less often.
  if (mask.height < kBandShape) return;
  for (int y = std::max(0, top - kBand + 1); y < bottom; ++y)
    BitRows::intersect(taken_, y, kBand, changed, bands_);
}

Place Strip::topmost(const Shape& shape, int first, int last) const {
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
