// An order in which neighbours are alike: what compression by blocks of rows and columns needs.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "luxel/base/progress.h"

namespace luxel::matrix {

/// The greedy path of [Shcherbakov17, section 3.5]: starts at point 0 and goes on to the nearest
/// point not yet met, by Euclidean distance; the first of equally near ones. Of
/// `points.size() / dimensions` points. n^2 / 2 distances. Stops short when cancelled.
std::vector<uint32_t> greedy_order(std::span<const float> points, size_t dimensions,
                                   const Progress& progress);

/// Rows or columns of a picture of bytes, as points of a space of kProjected dimensions.
struct ByteRows {
  const uint8_t* data = nullptr;  ///< RGBA pixels; A does not count
  size_t count = 0, length = 0;   ///< rows, and pixels per row
  size_t row_step = 0, step = 0;  ///< pixels from row to row, and along a row
};

/// Squared distances between n points of a thousand dimensions and more survive a projection on so
/// many random ones to within sqrt(2 / 128) = 12 %. [Johnson84; Achlioptas03: signs will do]
inline constexpr size_t kProjected = 128;

/// kProjected numbers per row. Stops short when cancelled.
std::vector<float> project(const ByteRows& rows, const Progress& progress);

}  // namespace luxel::matrix
