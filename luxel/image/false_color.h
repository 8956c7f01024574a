// Measures as pictures. What is not covered is a checkerboard of two greys.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "luxel/image/codec.h"
#include "luxel/image/compare.h"

namespace luxel::image {

using Color8 = std::array<uint8_t, 3>;  ///< display values of sRGB

/// The colour of t in [0, 1] (clamped): from near black over violet, red and orange to pale yellow.
/// The lightness grows linearly, so that the order of values is seen, in print too.
Color8 false_color(double t);

/// A one-channel map in false colours, low dark and high bright; beyond them the end's colour.
Image8 draw_map(const Image& map, const Mask& covered, double low, double high);

/// The colour of contour level `index` of `count`, and contours (contours() gives them) over the
/// faded picture of brightness.
Color8 contour_color(size_t index, size_t count);
Image8 draw_contours(std::span<const uint8_t> contours, std::span<const uint8_t> brightness,
                     int width, const Mask& covered, size_t level_count);

/// Black where the difference is above the level, white elsewhere, as in [Moreno05, figure 5.5].
Image8 draw_threshold(std::span<const uint8_t> differences, int width, const Mask& covered,
                      uint8_t level);

/// The picture with three channels and the checkerboard where nothing is covered.
Image8 draw_covered(const Image8& picture, const Mask& covered);

}  // namespace luxel::image
