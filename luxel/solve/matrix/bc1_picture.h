// The matrix as a picture of 8 bits per channel: what blocks are made of. [Shcherbakov17, 3.5]
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "luxel/solve/matrix/bc1.h"

namespace luxel::matrix {

/// Divides each column by its mean, which is returned. Columns of nothing stay.
std::vector<Rgb> even_columns(ColourMatrix& matrix);

/// The columns of each row that are kept, ascending.
using KeptColumns = std::vector<std::vector<uint32_t>>;
/// The largest `share` of every row and channel; of equal ones the first.
/// Unfinished when cancelled.
KeptColumns choose_kept(const ColourMatrix& matrix, float share, const Progress& progress);

/// The rest in 8 bits: RGBA, row by row. A is 0 where the entry is kept, else 255.
struct Picture {
  size_t n = 0;
  std::vector<uint8_t> rgba;
  std::array<float, 3> largest{};  ///< per channel, of the rest

  uint8_t* at(size_t row, size_t column) { return rgba.data() + 4 * (row * n + column); }
  const uint8_t* at(size_t row, size_t column) const {
    return rgba.data() + 4 * (row * n + column);
  }
  bool is_kept(size_t row, size_t column) const { return at(row, column)[3] == 0; }
};

/// Fits params.log_range where it is 0. Unfinished when cancelled.
Picture picture_of(const ColourMatrix& matrix, const KeptColumns& kept, Bc1Params& params,
                   const Progress& progress);

}  // namespace luxel::matrix
