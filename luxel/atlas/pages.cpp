#include "luxel/atlas/pages.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "luxel/base/check.h"

namespace luxel::atlas {
namespace {

/// Shelves as wide as `width`, large squares first; returns the rows they take.
int64_t fill_shelves(std::span<const int> sides, const std::vector<uint32_t>& large_first, int gap,
                     int64_t width, std::vector<Page>& pages) {
  int64_t x = 0, y = 0, shelf = 0;
  for (const uint32_t p : large_first) {
    const int64_t side = sides[p];
    if (x > 0 && x + side > width) {
      y += shelf + gap;
      x = 0;
    }
    if (x == 0) shelf = side;  // the largest that is left
    pages[p] = {int(x), int(y), int(side)};
    x += side + gap;
  }
  return y + shelf;
}

}  // namespace

std::vector<Page> pages_of(const Atlas& atlas) {
  if (atlas.pages.empty()) return {{0, 0, atlas.resolution}};
  return atlas.pages;
}

uint32_t page_of(const Atlas& atlas, uint32_t triangle_number) {
  return atlas.page.empty() ? 0 : atlas.page[triangle_number];
}

Status check_room(int pages, int side, int gutter) {
  const int64_t across = (kMaxMapSide + gutter) / (side + gutter);
  if (pages <= across * across) return {};
  return fail(ErrorCode::bad_setting,
              "{} pages of {} x {} texels: there is room for {} of them; choose fewer or smaller "
              "ones",
              pages, side, side, across * across);
}

Arrangement arrange_pages(std::span<const int> sides, int gap) {
  LUXEL_CHECK(!sides.empty());
  std::vector<uint32_t> large_first(sides.size());
  std::iota(large_first.begin(), large_first.end(), 0u);
  std::stable_sort(large_first.begin(), large_first.end(),
                   [&](uint32_t a, uint32_t b) { return sides[a] > sides[b]; });
  double area = 0;
  for (const int side : sides) area += std::pow(double(side) + gap, 2);
  int64_t width = std::max(int64_t(sides[large_first.front()]), int64_t(std::sqrt(area)) - gap);
  Arrangement out;
  out.pages.resize(sides.size());
  while (fill_shelves(sides, large_first, gap, width, out.pages) > width)
    width += std::max<int64_t>(1, width / 64);
  for (const Page& page : out.pages)
    out.side = std::max({out.side, page.x + page.side, page.y + page.side});
  return out;
}

}  // namespace luxel::atlas
