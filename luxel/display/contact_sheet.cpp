#include "luxel/display/contact_sheet.h"

#include <algorithm>
#include <cmath>

#include "luxel/base/check.h"
#include "luxel/image/text.h"

namespace luxel::display {
namespace {

constexpr int kGap = 8;
constexpr image::Color8 kPaper{236, 236, 236}, kInk{20, 20, 20};

/// The lines under a picture: large letters where the tile has room for the longest names.
int label_scale(int tile_width) { return tile_width >= 200 ? 2 : 1; }
int label_height(int scale) { return image::kGlyphHeight * scale + 2 * scale + 2; }

image::Image8 paper(int width, int height) {
  image::Image8 sheet{width, height, 3, {}};
  sheet.data.resize(size_t(width) * size_t(height) * 3);
  for (size_t i = 0; i < sheet.data.size(); ++i) sheet.data[i] = kPaper[i % 3];
  return sheet;
}

void place_picture(const image::Image8& picture, int x0, int y0, image::Image8& sheet) {
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const size_t from =
          (size_t(y) * size_t(picture.width) + size_t(x)) * size_t(picture.channels);
      const size_t to = (size_t(y0 + y) * size_t(sheet.width) + size_t(x0 + x)) * 3;
      for (size_t k = 0; k < 3; ++k) sheet.data[to + k] = picture.data[from + k];
    }
}

/// As much of the label as fits: a name that runs into its neighbour says nothing.
std::string fitting(std::string label, int width, int scale) {
  while (!label.empty() && image::text_width(label, scale) > width) label.pop_back();
  return label;
}

}  // namespace

int columns_for(size_t tiles, int tile_width, int tile_height) {
  int best = 1;
  double best_distance = INFINITY;
  for (int columns = 1; columns <= int(tiles); ++columns) {
    const int rows = (int(tiles) + columns - 1) / columns;
    const double shape = double(columns) * tile_width / (double(rows) * tile_height);
    const double distance = std::abs(std::log(shape * 3 / 4));
    if (distance < best_distance) best = columns, best_distance = distance;
  }
  return best;
}

image::Image8 contact_sheet(std::span<const Tile> tiles) {
  LUXEL_CHECK(!tiles.empty());
  const int width = tiles[0].picture.width, height = tiles[0].picture.height;
  const int scale = label_scale(width), cell = height + label_height(scale);
  const int columns = columns_for(tiles.size(), width, cell);
  const int rows = (int(tiles.size()) + columns - 1) / columns;
  image::Image8 sheet = paper(columns * (width + kGap) + kGap, rows * (cell + kGap) + kGap);
  for (size_t i = 0; i < tiles.size(); ++i) {
    const Tile& tile = tiles[i];
    LUXEL_CHECK(tile.picture.width == width && tile.picture.height == height &&
                tile.picture.channels >= 3);
    const int x = kGap + int(i) % columns * (width + kGap);
    const int y = kGap + int(i) / columns * (cell + kGap);
    place_picture(tile.picture, x, y, sheet);
    image::draw_text(sheet, x, y + height + scale + 2, scale, kInk,
                     fitting(tile.label, width, scale));
  }
  return sheet;
}

}  // namespace luxel::display
