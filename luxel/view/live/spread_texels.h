// Few texels that stand for all: close together where something was edited, farther apart
// elsewhere.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "luxel/base/vec.h"

namespace luxel::view {

/// Texels of surfaces in the world.
struct TexelPlaces {
  std::span<const Vec3> position, normal;  ///< [m]; unit
  /// Body of each texel, by number: bodies move on their own, and texels of one stand for no other.
  std::span<const uint32_t> body;
  float texel_m2 = 0;  ///< what a texel covers of them in the mean
};

/// Space is cut into cubes, whose sides double with the distance from what was edited, and each
/// cube by the six axes into what faces them. A texel lies in one of these cells.
struct CellGrid {
  float finest_m = 1;        ///< side of the smallest cubes
  std::vector<Box3> edited;  ///< where; none: all cubes are of the smallest size

  /// Sides are finest_m times 2 to the power of it.
  int level_at(Vec3 place) const;
  float side_m(int level) const { return finest_m * float(uint32_t(1) << level); }
};

/// A share of what is known in a cell.
struct CellShare {
  uint32_t cell = 0;
  float weight = 0;
};
/// Those of the eight cubes around a place, by up to three axes each.
inline constexpr size_t kMostShares = 24;

/// A cell, and those in the 26 cubes around its own that face the same axis.
struct CellsBeside {
  std::array<uint32_t, 27> cells{};
  size_t count = 0;
};

/// One texel for each cell that has any.
class SpreadTexels {
 public:
  /// `most`: so many cells as may be, about; the grid's finest_m follows from it, but is not below
  /// the one that is given.
  SpreadTexels(const TexelPlaces& places, CellGrid grid, size_t most);

  size_t size() const { return texel_.size(); }
  /// The texel of each cell: the one nearest to its middle.
  std::span<const uint32_t> texels() const { return texel_; }
  /// The cell of each texel.
  std::span<const uint32_t> cell_of_texel() const { return cell_of_texel_; }
  int level_of(size_t texel) const { return level_[texel]; }
  /// Shares of cells in a texel's light. They change evenly from place to place and from normal to
  /// normal. Returns how many of `out` there are; weights add up to anything above 0, or there are
  /// none.
  size_t shares_at(size_t texel, std::array<CellShare, kMostShares>& out) const;
  /// Neighbours of each cell.
  std::vector<CellsBeside> beside() const;

 private:
  /// Cells of the 27 cubes around and including one's own, x first: kNoCell where there is none.
  using CellsAround = std::array<uint32_t, 27>;

  /// Where a key is in the hash table, or would be.
  size_t place_of(uint64_t key) const;
  uint32_t find(uint64_t key) const;
  void grow();
  void number_cells(std::span<const uint64_t> keys, std::span<const float> off);
  void find_around();

  TexelPlaces places_;
  CellGrid grid_;
  std::vector<uint32_t> texel_, cell_of_texel_;
  std::vector<uint8_t> level_;
  std::vector<uint64_t> keys_;   ///< of a hash table of a power of 2 of places; 0: empty
  std::vector<uint32_t> cells_;  ///< of each of its places
  std::vector<CellsAround> around_;
};

}  // namespace luxel::view
