// The matrix as it is: the yardstick of all other codecs, and the paper's "naive".
#pragma once

#include <cstdint>
#include <vector>

namespace luxel::matrix {

/// F_ij, n x n, row by row, in one of two precisions; the other vector is empty.
struct Dense {
  uint32_t n = 0;
  std::vector<float> single;
  std::vector<uint16_t> half;  ///< IEEE 754 binary16
};

}  // namespace luxel::matrix
