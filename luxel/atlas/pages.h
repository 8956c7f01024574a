// The pages of an atlas: one internal square for the solvers, several lightmaps for the user.
#pragma once

#include <span>
#include <vector>

#include "luxel/atlas/atlas.h"
#include "luxel/base/result.h"

namespace luxel::atlas {

/// At least one.
std::vector<Page> pages_of(const Atlas& atlas);
/// The page of a drawn triangle, as an index into pages_of().
uint32_t page_of(const Atlas& atlas, uint32_t triangle_number);

/// A square that holds pages.
struct Arrangement {
  int side = 0;
  std::vector<Page> pages;  ///< in the order of their sides
};
/// Lays squares of these sides (all > 0) on shelves of a square that is about as small as can be,
/// `gap` empty texels between them, so that lookups and repairs over a page's rim find nothing of
/// its neighbour, as between charts.
Arrangement arrange_pages(std::span<const int> sides, int gap);

/// Texels are numbered in 29 bits with a border of one around them
/// (luxel/solve/gather/rays/hit_store.h).
inline constexpr int kMaxMapSide = 23168;
inline constexpr int kMaxPages = 4096;
/// Error (bad_setting): so many pages of one side do not fit an atlas.
Status check_room(int pages, int side, int gutter);

}  // namespace luxel::atlas
