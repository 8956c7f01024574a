#include "atlas/pack.h"

#include <algorithm>
#include <bit>
#include <numeric>
#include <tuple>

namespace luxel::atlas {
namespace {

constexpr uint64_t kFull = ~uint64_t(0);

/// The square's taken texels, 64 to a word. Level k of a row tells for each column whether any of
/// the 2^k texels from there to the right is taken; what lies right of the strip is taken. A run
/// of n free texels is then two bits of one level: 64 columns are tested at once.
class Strip {
 public:
  explicit Strip(int width) : words_((size_t(width) + 63) / 64), height_(width), levels_(1) {
    while (levels_ < 7 && (1 << levels_) <= width) ++levels_;
    bits_.assign(size_t(height_) * size_t(levels_) * words_, 0);
    free_level_.assign(size_t(height_), levels_ - 1);
    if (width % 64 != 0)
      for (int y = 0; y < height_; ++y) row(y, 0)[words_ - 1] = kFull << (width % 64);
    for (int y = 0; y < height_; ++y) refresh(y);
  }

  size_t words() const { return words_; }
  int height() const { return height_; }

  /// No run of 2^level free texels in the row: a quick way to say no.
  bool too_full(int y, int level) const { return free_level_[size_t(y)] < level; }
  int levels() const { return levels_; }

  /// Marks in `blocked` the columns where [run) meets taken texels of row y.
  void block(int y, Span run, std::vector<uint64_t>& blocked) const {
    const int length = run.end - run.begin;
    const int level = std::min(levels_ - 1, int(std::bit_width(unsigned(length))) - 1);
    const uint64_t* bits = row(y, level);
    const int step = 1 << level;
    for (int at = run.begin; at + step < run.end; at += step) add_shifted(bits, at, blocked);
    add_shifted(bits, run.end - step, blocked);
  }

  void take(int y, Span run) {
    uint64_t* bits = row(y, 0);
    for (int x = run.begin; x < run.end;) {
      const int end = std::min(run.end, (x / 64 + 1) * 64);
      const uint64_t ones = end - x == 64 ? kFull : (uint64_t(1) << (end - x)) - 1;
      bits[x / 64] |= ones << (x % 64);
      x = end;
    }
  }

  /// Builds the higher levels of a row after texels of it were taken.
  void refresh(int y) {
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

 private:
  uint64_t* row(int y, int level) {
    return &bits_[(size_t(y) * size_t(levels_) + size_t(level)) * words_];
  }
  const uint64_t* row(int y, int level) const {
    return &bits_[(size_t(y) * size_t(levels_) + size_t(level)) * words_];
  }

  void add_shifted(const uint64_t* bits, int offset, std::vector<uint64_t>& blocked) const {
    const size_t skip = std::min(words_, size_t(offset) / 64);
    const int shift = offset % 64;
    const size_t inside = words_ - skip;  // words of `blocked` whose source starts in the strip
    if (shift == 0) {
      for (size_t w = 0; w < inside; ++w) blocked[w] |= bits[w + skip];
    } else {
      for (size_t w = 0; w + 1 < inside; ++w)
        blocked[w] |= bits[w + skip] >> shift | bits[w + skip + 1] << (64 - shift);
      if (inside > 0) blocked[inside - 1] |= bits[words_ - 1] >> shift | kFull << (64 - shift);
    }
    for (size_t w = inside; w < words_; ++w) blocked[w] = kFull;
  }

  size_t words_;
  int height_, levels_;
  std::vector<uint64_t> bits_;
  std::vector<int> free_level_;
};

/// A mask's runs in the order of testing: the widest first, they fail soonest.
struct Shape {
  const Mask* mask = nullptr;
  struct Run {
    int row;
    Span columns;
    int level;
  };
  std::vector<Run> runs;
};

Shape make_shape(const Mask& mask, int levels) {
  Shape shape{&mask, {}};
  for (int j = 0; j < mask.height; ++j)
    for (const Span run : mask.rows[size_t(j)])
      shape.runs.push_back(
          {j, run, std::min(levels - 1, int(std::bit_width(unsigned(run.end - run.begin))) - 1)});
  std::stable_sort(shape.runs.begin(), shape.runs.end(), [](const auto& a, const auto& b) {
    return a.columns.end - a.columns.begin > b.columns.end - b.columns.begin;
  });
  return shape;
}

/// The leftmost free column for a shape with its top at row y, or -1.
int free_column(const Strip& strip, const Shape& shape, int y, std::vector<uint64_t>& blocked) {
  for (size_t r = 0; r < std::min<size_t>(24, shape.runs.size()); ++r)
    if (strip.too_full(y + shape.runs[r].row, shape.runs[r].level)) return -1;
  std::fill(blocked.begin(), blocked.end(), 0);
  for (const Shape::Run& run : shape.runs) {
    strip.block(y + run.row, run.columns, blocked);
    if (std::all_of(blocked.begin(), blocked.end(), [](uint64_t w) { return w == kFull; }))
      return -1;
  }
  for (size_t w = 0; w < blocked.size(); ++w)
    if (blocked[w] != kFull) return int(64 * w) + std::countr_one(blocked[w]);
  return -1;
}

/// Where the search for a rectangle's size begins: above, no mask of that size or smaller has found
/// room, and taken texels are never given back.
class FirstRows {
 public:
  int at(int width, int height) const { return rows_[index(width, height)]; }
  void raise(int width, int height, int row) {
    if (at(width, height) >= row) return;  // larger sizes never start above smaller ones
    for (int w = std::min(width, kMost); w <= kMost; ++w)
      for (int h = std::min(height, kMost); h <= kMost; ++h) {
        int& r = rows_[index(w, h)];
        r = std::max(r, row);
      }
  }

 private:
  static constexpr int kMost = 48;
  static size_t index(int w, int h) {
    return size_t(std::min(w, kMost)) * (kMost + 1) + size_t(std::min(h, kMost));
  }
  std::vector<int> rows_ = std::vector<int>((kMost + 1) * (kMost + 1), 0);
};

/// The topmost place for a shape between rows [first, last], or y = -1.
Place topmost(const Strip& strip, const Shape& shape, int first, int last,
              std::vector<uint64_t>& blocked) {
  last = std::min(last, strip.height() - shape.mask->height);
  for (int y = first; y <= last; ++y) {
    const int x = free_column(strip, shape, y, blocked);
    if (x >= 0) return {x, y, 0};
  }
  return {-1, -1, 0};
}

/// Takes the mask's texels and all within `gutter` of them.
void take_with_gutter(Strip& strip, const Mask& mask, Place place, int gutter, int width) {
  const int top = std::max(0, place.y - gutter);
  const int bottom = std::min(strip.height(), place.y + mask.height + gutter);
  for (int y = top; y < bottom; ++y) {
    const int first = std::max(0, y - place.y - gutter);
    const int last = std::min(mask.height - 1, y - place.y + gutter);
    for (int j = first; j <= last; ++j)
      for (const Span run : mask.rows[size_t(j)])
        strip.take(y, {std::max(0, place.x + run.begin - gutter),
                       std::min(width, place.x + run.end + gutter)});
    strip.refresh(y);
  }
}

/// Of the four quarter turns the one whose bottom comes out highest; y = -1 when none fits.
std::pair<Place, Mask> best_place(const Strip& strip, const Mask& upright,
                                  const FirstRows& first_rows) {
  std::vector<uint64_t> blocked(strip.words());
  // Half a turn makes no difference to a shape that nearly fills its rectangle.
  const bool full = double(upright.texels) > 0.95 * upright.width * upright.height;
  Place best{-1, -1, 0};
  Mask chosen, mask = upright;
  for (int turns = 0; turns < (full ? 2 : 4); ++turns) {
    const int last = best.y < 0 ? strip.height() : best.y + chosen.height - mask.height - 1;
    Place place = topmost(strip, make_shape(mask, strip.levels()),
                          first_rows.at(mask.width, mask.height), last, blocked);
    Mask next = turned(mask);
    if (place.y >= 0) {
      place.turns = turns;
      best = place;
      chosen = std::move(mask);
    }
    mask = std::move(next);
  }
  return {best, std::move(chosen)};
}

std::vector<uint32_t> large_first(const std::vector<Mask>& masks) {
  std::vector<uint32_t> order(masks.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto key = [&](uint32_t m) {
    const Mask& k = masks[m];
    const int longest = std::max(k.width, k.height), shortest = std::min(k.width, k.height);
    return std::tuple(-longest, -shortest, -int64_t(k.texels), m);
  };
  std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return key(a) < key(b); });
  return order;
}

}  // namespace

Packing pack_masks(const std::vector<Mask>& masks, int width, int gutter,
                   const Progress& progress) {
  Strip strip(width);
  FirstRows first_rows;
  Packing packing;
  packing.places.resize(masks.size());
  packing.placed = 0;
  uint64_t total = 0, placed = 0;
  for (const Mask& m : masks) total += m.texels;
  for (const uint32_t m : large_first(masks)) {
    if (progress.cancelled()) return packing;
    const auto [place, chosen] = best_place(strip, masks[m], first_rows);
    if (place.y < 0) {
      packing.placed = double(placed) / double(total);
      return packing;
    }
    first_rows.raise(chosen.width, chosen.height, place.y);
    take_with_gutter(strip, chosen, place, gutter, width);
    packing.places[m] = place;
    packing.height = std::max(packing.height, place.y + chosen.height);
    placed += chosen.texels;
  }
  packing.placed = 1;
  return packing;
}

}  // namespace luxel::atlas
