// The square's taken texels, and where a shape finds room among them.
#pragma once

#include <cstdint>
#include <vector>

#include "luxel/atlas/pack.h"

namespace luxel::atlas {

/// A mask's runs in the order of testing: the widest first, they fail soonest.
struct Shape {
  struct Run {
    int row = 0;
    Span columns;
  };
  int width = 0, height = 0;
  std::vector<Run> runs;
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
  /// Row y of `all` becomes the columns that are set in each of `rows` rows from y on.
  static void intersect(const BitRows& rows, int y, int row_count, BitRows& all);
  /// Builds the higher levels of a row after its bits changed.
  void refresh(int y);
  /// Whether the row has no run of clear bits as long as the columns: a quick way to say no.
  bool too_full(int y, Span columns) const { return free_level_[size_t(y)] < level_of(columns); }
  /// Sets in `blocked` the offsets at which the columns meet set bits of row y.
  void block(int y, Span columns, std::vector<uint64_t>& blocked) const;

 private:
  int level_of(Span columns) const;
  uint64_t* row(int y, int level);
  const uint64_t* row(int y, int level) const;
  void add_shifted(const uint64_t* bits, int offset, std::vector<uint64_t>& blocked) const;

  size_t words_;
  int count_, levels_;
  std::vector<uint64_t> bits_;
  std::vector<int> free_level_;  ///< per row, the highest level with a clear bit; -1: none
};

/// A square in which texels are taken and never given back.
class Strip {
 public:
  explicit Strip(int side) : taken_(side), bands_(side), blocked_words_(taken_.words()) {}

  int side() const { return taken_.count(); }
  /// Takes the mask's texels and all within `gutter` of them.
  void take_with_gutter(const Mask& mask, ChartPosition place, int gutter);
  /// The topmost place for a shape with its top between rows [first, last], the leftmost of these;
  /// y = -1: none.
  ChartPosition topmost(const Shape& shape, int first, int last) const;

 private:
  BitRows taken_;
  /// Row y: what is taken in all of the kBand rows from y on. Where a shape has no room on these,
  /// it has none with its top in any of the rows: most rows need no test of their own.
  BitRows bands_;
  size_t blocked_words_;
};

}  // namespace luxel::atlas
