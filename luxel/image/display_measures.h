// Differences of two pictures on a screen, in steps of 0 to 255: the measures of [Moreno05, chapter
// 5]. All take 8-bit display values with 3 or 4 channels; the fourth is not looked at.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "luxel/image/codec.h"
#include "luxel/image/compare.h"

namespace luxel::image {

/// Brightness values of the contours of figure 5.2, and levels of difference of figure 5.5.
inline constexpr std::array<uint8_t, 5> kContourLevels{40, 70, 90, 120, 140};
inline constexpr std::array<uint8_t, 3> kDifferenceLevels{10, 25, 40};

/// Pixels per value.
using Histogram = std::array<uint64_t, 256>;

/// Brightness per pixel: the Rec. 709 weights on display values, rounded.
std::vector<uint8_t> brightness(const Image8& image);
/// Difference per pixel: the largest of its channels. Both of one size.
std::vector<uint8_t> pixel_differences(const Image8& a, const Image8& b);

/// Counts the covered pixels.
Histogram histogram(std::span<const uint8_t> values, const Mask& covered);
/// The share of the counted pixels whose value is above `level`, in [0, 1].
double share_above(const Histogram& counts, uint8_t level);

/// Where the brightness goes through a level: per pixel 0, or 1 + the index of the highest level
/// that lies above a covered neighbour (right, left, below, above) and not above the pixel.
std::vector<uint8_t> contours(std::span<const uint8_t> values, int width, const Mask& covered,
                              std::span<const uint8_t> levels);

}  // namespace luxel::image
