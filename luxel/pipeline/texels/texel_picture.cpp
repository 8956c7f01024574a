#include "luxel/pipeline/texels/texel_picture.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "luxel/atlas/pages.h"
#include "luxel/base/check.h"
#include "luxel/image/false_color.h"

namespace luxel::pipeline {
namespace {

using Color = image::Color8;

constexpr Color kBlack{0, 0, 0}, kMagenta{220, 30, 200}, kMovedColor{40, 190, 70},
    kRefilledColor{240, 200, 40}, kSeamColor{230, 30, 30};
constexpr Color kLight{205, 205, 205}, kDark{160, 160, 160}, kBorder{95, 105, 140};
constexpr uint32_t kSquare = 8;
constexpr float kFullRed = 0.05f;

bool on_border(const atlas::Atlas& atlas, const atlas::TexelMap& map, const atlas::Texel& t) {
  const int side = map.resolution;
  for (const auto& [dx, dy] : {std::pair(-1, 0), {1, 0}, {0, -1}, {0, 1}}) {
    const int x = int(t.x) + dx, y = int(t.y) + dy;
    if (x < 0 || y < 0 || x >= side || y >= side) return true;
    const uint32_t other = map.texel_at[size_t(y) * size_t(side) + size_t(x)];
    if (other == atlas::kNone ||
        atlas.chart[map.texels[other].triangle_number] != atlas.chart[t.triangle_number])
      return true;
  }
  return false;
}

Color mix(Color a, Color b, float s) {
  Color out;
  for (size_t c = 0; c < 3; ++c)
    out[c] = uint8_t(std::lround(float(a[c]) * (1 - s) + float(b[c]) * s));
  return out;
}

/// A picture of each page, white where no texel is.
std::vector<image::Image8> pages_in(std::span<const Color> color, const atlas::Atlas& atlas,
                                    const atlas::TexelMap& map) {
  const std::vector<atlas::Page> pages = atlas::pages_of(atlas);
  std::vector<image::Image8> pictures;
  for (const atlas::Page& page : pages) {
    const auto side = size_t(page.side);
    pictures.push_back({page.side, page.side, 3, std::vector<uint8_t>(3 * side * side, 255)});
  }
  for (size_t i = 0; i < color.size(); ++i) {
    const atlas::Texel& t = map.texels[i];
    const uint32_t p = atlas::page_of(atlas, t.triangle_number);
    const size_t x = size_t(int(t.x) - pages[p].x), y = size_t(int(t.y) - pages[p].y);
    const size_t at = y * size_t(pages[p].side) + x;
    std::copy(color[i].begin(), color[i].end(), pictures[p].data.begin() + long(3 * at));
  }
  return pictures;
}

}  // namespace

std::vector<image::Image8> draw_texels(const atlas::Atlas& atlas, const atlas::TexelMap& map,
                                       const TexelFacts& facts) {
  std::vector<Color> color(map.texels.size());
  for (size_t i = 0; i < color.size(); ++i) {
    const atlas::Texel& t = map.texels[i];
    color[i] = ((t.x / kSquare + t.y / kSquare) & 1u) ? kDark : kLight;
    if (on_border(atlas, map, t)) color[i] = kBorder;
    if (!facts.seam_error.empty())
      color[i] = mix(color[i], kSeamColor, std::min(1.0f, facts.seam_error[i] / kFullRed));
  }
  for (const uint32_t i : facts.moved) color[i] = kMovedColor;
  for (size_t i = 0; i < facts.hidden.size(); ++i)
    if (facts.hidden[i]) color[i] = kBlack;
  for (const uint32_t i : facts.refilled) color[i] = kRefilledColor;
  for (const uint32_t i : facts.overlapping) color[i] = kMagenta;
  return pages_in(color, atlas, map);
}

std::vector<image::Image8> draw_errors(const atlas::Atlas& atlas, const atlas::TexelMap& map,
                                       std::span<const float> errors) {
  LUXEL_CHECK(errors.size() == map.texels.size());
  std::vector<Color> color(errors.size());
  for (size_t i = 0; i < color.size(); ++i) {
    const float over = std::max(errors[i], kLowestError) / kLowestError;
    color[i] = image::false_color(double(std::log(over) / std::log(kHighestError / kLowestError)));
  }
  return pages_in(color, atlas, map);
}

}  // namespace luxel::pipeline
