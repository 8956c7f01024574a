// All bounces in one product: matrices with an entry per colour channel. [Shcherbakov17, 3.4]
//
// The paper's matrix F^c has entries F_ij colour_j [eq. 5], and sum_h (F^c)^h maps direct
// irradiance. Ours is
//
//   K = sum_{h < k} (F rho)^h F,    E_k = K B_0,
//
// the same sum with the last colour left off: column j of the paper's is ours times colour_j. What
// patches send at first, B_0 = B_e + rho D, is the product's input, so that patches of no colour
// can emit, and A_i K_ij = A_j K_ji holds as it does for F.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/solve/matrix/dense.h"
#include "luxel/solve/matrix/form_factors.h"

namespace luxel::matrix {

/// n x n entries per channel, row by row.
struct ColourMatrix {
  uint32_t n = 0;
  std::array<std::vector<float>, 3> channel;

  size_t size() const { return n; }
};

/// F^c of [Shcherbakov17, eq. 5], F_ij rho_j: its product with irradiance is one more bounce.
ColourMatrix make_colour_factors(const FormFactors& factors, std::span<const Rgb> reflectance);

/// K of `bounces` products (at least one), or of all if `bounces` < 0. `factors` are reciprocal.
/// In float: 12 n^2 bytes, and as much again while it works. Counted bounces cost one product of
/// the sparse F with a dense matrix each; the limit a Cholesky factorisation per channel, whatever
/// the reflectances. Errors: all light stays for ever (no factorisation), cancelled.
Result<ColourMatrix> make_reflections(const FormFactors& factors, std::span<const Rgb> reflectance,
                                      std::span<const float> area_m2, int bounces,
                                      Progress& progress);

/// E = K B. Allocates nothing.
void multiply(const ColourMatrix& matrix, std::span<const Rgb> radiosity, std::span<Rgb> irradiance,
              DenseScratch& scratch);

/// Bytes of all three channels.
uint64_t bytes_of(const ColourMatrix& matrix);

}  // namespace luxel::matrix
