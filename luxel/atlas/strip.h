// The square's taken texels, and where a shape finds room among them.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <utility>
#include <vector>

#include "luxel/atlas/mask.h"

namespace luxel::atlas {

/// A mask's runs in the order of testing: those first that fail soonest.
struct Shape {
  int width = 0, height = 0;
  /// Mean row of its texels. Unlike its bottom, this shows that a shape whose bulk is above leaves
  /// room for others beside its tip.
  double mean_row = 0;
  std::vector<RowRun> runs;
  /// The largest rectangle among the lengths of the rows' longest runs: each of these rows has a
  /// run of `core_length` columns or more.
  Span core_rows;
  int core_length = 0;
};
Shape make_shape(const Mask& mask);

/// Rows of bits, 64 to a word. Level k of a row tells for each column whether any of the 2^k bits
/// from there to the right is set; what lies right of the last column is set. A run of n clear bits
/// is then two bits of one level: 64 columns are tested at once.
class BitRows {
 public:
  explicit BitRows(int side);

  size_t words() const { return words_; }
  int count() const { return count_; }
  void set(int y, Span columns);
  /// Builds the higher levels of a row of which no others than these columns were set.
  void refresh(int y, Span changed);
  /// The length of the row's longest run of clear bits.
  int longest_clear(int y) const { return longest_clear_[size_t(y)]; }
  /// Sets in `blocked` the offsets at which the columns meet set bits of row y.
  void block(int y, Span columns, std::vector<uint64_t>& blocked) const;
  /// The word of these offsets that begins at 64 * word.
  uint64_t blocked_word(int y, Span columns, size_t word) const {
    const int level = level_of(columns), step = 1 << level;
    const uint64_t* bits = row(y, level);
    uint64_t out = bits_from(bits, word, columns.end - step);
    for (int at = columns.begin; at + step < columns.end; at += step)
      out |= bits_from(bits, word, at);
    return out;
  }

 private:
  int level_of(Span columns) const {
    return std::min(levels_ - 1, int(std::bit_width(unsigned(columns.end - columns.begin))) - 1);
  }
  size_t begin_of(int y, int level) const {
    return (size_t(level) * size_t(count_) + size_t(y)) * words_;
  }
  uint64_t* row(int y, int level) { return &bits_[begin_of(y, level)]; }
  const uint64_t* row(int y, int level) const { return &bits_[begin_of(y, level)]; }
  /// Words that hold these columns.
  std::pair<size_t, size_t> words_of(Span columns) const {
    return {size_t(columns.begin) / 64, std::min(words_, size_t(columns.end + 63) / 64)};
  }
  /// The 64 bits of a row from column 64 * word + offset on.
  uint64_t bits_from(const uint64_t* bits, size_t word, int offset) const {
    constexpr uint64_t kSet = ~uint64_t(0);
    const size_t at = word + size_t(offset) / 64;
    const int shift = offset % 64;
    if (at >= words_) return kSet;
    if (shift == 0) return bits[at];
    return bits[at] >> shift | (at + 1 < words_ ? bits[at + 1] : kSet) << (64 - shift);
  }
  void add_shifted(const uint64_t* bits, int offset, std::vector<uint64_t>& blocked) const;

  size_t words_;
  int count_, levels_;
  std::vector<uint64_t> bits_;
  std::vector<int> longest_clear_;        ///< per row
  std::vector<int> longest_clear_begin_;  ///< per row, where one of these runs begins
};

/// Where the upper left corner of a mask's rectangle lies.
struct Place {
  int x = 0, y = 0;
};

/// A square in which texels are taken and never given back.
class Strip {
 public:
  explicit Strip(int side) : taken_(side) {}

  int side() const { return taken_.count(); }
  /// Takes the texels of a mask with its upper left corner there, and no others: those outside of
  /// the square are left out.
  void take(const Mask& mask, Place at);
  /// The topmost place for a shape with its top between rows [first, last], the leftmost of these;
  /// y = -1: none.
  Place topmost(const Shape& shape, int first, int last) const;

 private:
  BitRows taken_;
};

}  // namespace luxel::atlas
