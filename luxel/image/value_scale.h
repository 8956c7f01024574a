// Values as false colours with their isolines, and the legend that says which colour is how much.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "luxel/image/codec.h"
#include "luxel/image/false_color.h"

namespace luxel::image {

/// False colours run from 0 to `top`; isolines lie at `levels`.
struct ValueScale {
  double top = 1;
  bool has_more = false;       ///< some values lie above the top
  std::vector<double> levels;  ///< ascending
  std::string unit;            ///< stands over the legend
};

/// A scale for these values. The top is a round number that 98 % of them stay below. The levels are
/// those of EN 12464-1 (..., 100, 150, 200, 300, 500, 750, 1000, ...) up to the largest value, the
/// ten highest at most; where fewer than four lie among the values, multiples of 1, 2 or 5 times a
/// power of ten. Values that are not finite do not count.
ValueScale scale_for(std::span<const float> values, std::string_view unit);

/// "0.5", "750", "20000".
std::string text_of_value(double value);

/// Colours of a picture of values, row by row; `background` where a value is not finite. An isoline
/// runs along the pixels at which the level changes to a neighbour; it stops where that is not
/// finite, or lies in another region of `region` (one number per pixel; empty: all in one).
Image8 draw_values(std::span<const float> values, int width, const ValueScale& scale,
                   Color8 background, std::span<const uint32_t> region = {});

/// Writes each isoline's value on it, where there is room; `taken` are centres of what is written
/// already, and those of the labels are added.
void label_isolines(Image8& picture, std::span<const float> values, const ValueScale& scale,
                    std::vector<std::array<int, 2>>& taken);

/// Text on a plate of white, centred.
void draw_label(Image8& picture, int centre_x, int centre_y, std::string_view text);

/// The picture with the legend to its right.
Image8 with_legend(const Image8& picture, const ValueScale& scale);

}  // namespace luxel::image
