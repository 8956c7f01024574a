// The matrix as it is: the yardstick of all other codecs, and the paper's "naive".
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "luxel/solve/matrix/form_factors.h"
#include "luxel/solve/matrix/instructions.h"

namespace luxel::matrix {

enum class Precision { single, half };

/// F_ij, n x n, row by row, in one of two precisions; the other vector is empty.
struct Dense {
  uint32_t n = 0;
  std::vector<float> single;
  std::vector<uint16_t> half;  ///< IEEE 754 binary16; what is below 6e-8 is lost

  size_t size() const { return n; }
};

/// F with a number for every pair: 4 n^2 bytes, or 2 n^2.
Dense make_dense(const FormFactors& factors, Precision precision);

/// Room for one product of a dense matrix: light channel by channel.
struct DenseScratch {
  std::vector<float> plane;  ///< three of them, each `stride` long
  size_t stride = 0;
};
/// Allocates for one product at a time.
DenseScratch make_dense_scratch(size_t patches);

/// E = F B. Allocates nothing. The same bits on all processors.
void multiply(const Dense& matrix, std::span<const Rgb> radiosity, std::span<Rgb> irradiance,
              DenseScratch& scratch);
/// By instructions that this processor has, for tests.
void multiply(const Dense& matrix, std::span<const Rgb> radiosity, std::span<Rgb> irradiance,
              DenseScratch& scratch, Instructions instructions);

/// Bytes of the matrix.
uint64_t bytes_of(const Dense& matrix);

/// Light into planes, one per channel.
void split_channels(std::span<const Rgb> light, DenseScratch& scratch);

/// sum_j row_j plane_j of `n` numbers.
float inner_product(const float* row, const float* plane, size_t n);

}  // namespace luxel::matrix
