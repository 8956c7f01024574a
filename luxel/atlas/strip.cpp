#include "luxel/atlas/strip.h"

#include <algorithm>
#include <bit>
#include <span>
#include <tuple>

namespace luxel::atlas {
namespace {

constexpr uint64_t kFull = ~uint64_t(0);
int length_of(Span columns) { return columns.end - columns.begin; }

/// Visits the numbers below a count, each far from those just before it: in the order of their
/// reversed bits.
template <class Visit>
void for_each_spread(size_t count, const Visit& visit) {
  const size_t most = size_t(1) << std::bit_width(count);
  for (size_t number = 0;;) {
    if (number < count) visit(number);
    // Counts on with reversed bits: a carry runs to the lower ones.
    size_t bit = most / 2;
    for (; number & bit; bit /= 2) number ^= bit;
    if (bit == 0) return;
    number |= bit;
  }
}

/// The longest run of clear bits, the leftmost of equals.
Span longest_clear_run(std::span<const uint64_t> bits) {
  Span best;
  int longest = 0, begin = 0;  // `begin`: of the clear bits before the word
  const auto end_at = [&](int end) {
    if (end - begin > longest) best = {begin, end}, longest = end - begin;
  };
  for (size_t w = 0; w < bits.size(); ++w) {
    const uint64_t word = bits[w];
    if (word == 0) continue;
    const int at = int(64 * w);
    end_at(at + std::countr_zero(word));
    begin = at + 64 - std::countl_zero(word);
    // Looks for a longer run within the word.
    uint64_t begins = ~word;  // where at least `have` clear bits begin
    for (int have = 1; begins != 0 && have <= longest;) {
      const int step = std::min(have, longest + 1 - have);
      begins &= begins >> step, have += step;
    }
    for (; begins != 0; begins &= begins >> 1) {
      const int first = at + std::countr_zero(begins);
      best = {first, first + ++longest};
    }
  }
  end_at(int(64 * bits.size()));
  return best;
}

/// The rows of the largest rectangle under a graph of lengths, and its length.
std::pair<Span, int> largest_rectangle(const std::vector<int>& lengths) {
  Span best_rows;
  int best_length = 0;
  struct Open {
    int begin, length;
  };
  std::vector<Open> open;  // rectangles that may go on below, each longer than those before
  for (int j = 0; j <= int(lengths.size()); ++j) {
    const int length = j < int(lengths.size()) ? lengths[size_t(j)] : 0;
    int begin = j;
    for (; !open.empty() && open.back().length >= length; open.pop_back()) {
      begin = open.back().begin;
      if (int64_t(j - begin) * open.back().length > int64_t(length_of(best_rows)) * best_length)
        best_rows = {begin, j}, best_length = open.back().length;
    }
    open.push_back({begin, length});
  }
  return {best_rows, best_length};
}

/// The leftmost free column for a shape with its top at row y, or -1.
int free_column(const BitRows& rows, const Shape& shape, int y, std::vector<uint64_t>& blocked) {
  // Long runs come first: one that is too full refuses the row before columns are looked at.
  constexpr size_t kQuick = 24;
  for (size_t r = 0; r < std::min(kQuick, shape.runs.size()); ++r)
    if (rows.longest_clear(y + shape.runs[r].row) < length_of(shape.runs[r].columns)) return -1;
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
  Shape shape;
  shape.width = mask.width, shape.height = mask.height;
  std::vector<RowRun> by_row;
  std::vector<int> longest_of_row(size_t(mask.height));
  double sum_of_rows = 0;
  for (int j = 0; j < mask.height; ++j)
    for (const Span run : mask.row(j)) {
      by_row.push_back({j, run});
      sum_of_rows += double(j) * length_of(run);
      longest_of_row[size_t(j)] = std::max(longest_of_row[size_t(j)], length_of(run));
    }
  shape.mean_row = sum_of_rows / double(std::max<uint64_t>(1, mask.texels));
  std::tie(shape.core_rows, shape.core_length) = largest_rectangle(longest_of_row);
  int longest = 0;
  for (const int length : longest_of_row) longest = std::max(longest, length);
  // Long runs fail soonest, and neighbouring rows are much alike: each run lies far from those
  // before it.
  shape.runs.reserve(by_row.size());
  std::vector<RowRun> short_runs;
  for_each_spread(by_row.size(), [&](size_t r) {
    const bool is_long = 2 * length_of(by_row[r].columns) >= longest;
    (is_long ? shape.runs : short_runs).push_back(by_row[r]);
  });
  shape.runs.insert(shape.runs.end(), short_runs.begin(), short_runs.end());
  return shape;
}

BitRows::BitRows(int side) : words_((size_t(side) + 63) / 64), count_(side), levels_(1) {
  while (levels_ < 7 && (1 << levels_) <= side) ++levels_;
  bits_.assign(size_t(count_) * size_t(levels_) * words_, 0);
  longest_clear_.assign(size_t(count_), side);
  longest_clear_begin_.resize(size_t(count_));
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
  int& length = longest_clear_[size_t(y)];
  int& begin = longest_clear_begin_[size_t(y)];
  if (changed.end <= begin || changed.begin >= begin + length) return;
  const Span clear = longest_clear_run({row(y, 0), words_});
  begin = clear.begin, length = length_of(clear);
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
}

Place Strip::topmost(const Shape& shape, int first, int last) const {
  std::vector<uint64_t> blocked(taken_.words());
  last = std::min(last, side() - shape.height);
  int row = first;  // those of the core above are not too full
  for (int y = first; y <= last; ++y) {
    // A row that is too full for the core refuses all places at which the core meets it.
    for (row = std::max(row, y + shape.core_rows.begin); row < y + shape.core_rows.end && y <= last;
         ++row)
      if (taken_.longest_clear(row) < shape.core_length) y = row + 1 - shape.core_rows.begin;
    if (y > last) break;
    if (const int x = free_column(taken_, shape, y, blocked); x >= 0) return {x, y};
  }
  return {-1, -1};
}

}  // namespace luxel::atlas
