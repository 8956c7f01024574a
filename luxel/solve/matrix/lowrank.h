// The matrix of form factors by its leading eigenvectors. [Fernandez12]
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/solve/matrix/form_factors.h"

namespace luxel::matrix {

/// The largest eigenvalues of S = A^1/2 F A^-1/2, which reciprocity makes symmetric, and their
/// orthonormal eigenvectors.
struct Spectrum {
  std::vector<float> value;   ///< the largest first, by absolute value; from -1 to 1
  std::vector<float> vector;  ///< patches x count, patch by patch
  double energy = 0;          ///< sum of the squares of all eigenvalues of S: sum S_ij^2

  size_t count() const { return value.size(); }
};

struct SpectrumParams {
  uint32_t count = 256;  ///< wanted; there are fewer where S has no more
  int iterations = 2;    ///< products that turn the random subspace towards the eigenvectors
  uint64_t seed = 1;
};

/// By randomised subspace iteration [Halko11, algorithms 4.4 and 5.3]: sparse products, no dense
/// matrix of patches x patches. `factors` are reciprocal. Errors: nothing is wanted, cancelled.
Result<Spectrum> spectrum_of(const FormFactors& factors, std::span<const float> area_m2,
                             const SpectrumParams& params, Progress& progress);

/// |S - S_r| / |S| in the norm of Frobenius: the relative error of one product by `rank` of the
/// eigenvalues for light that is independent from patch to patch, the worst there is.
double lost(const Spectrum& spectrum, size_t rank);

/// Number of eigenvalues that are `smallest` or larger by absolute value. A product by these misses
/// at most `smallest` of the light sent, in the norm sqrt(sum A_i B_i^2). Noise of the rays has
/// eigenvalues up to about 2 / sqrt(2 rays per patch): to keep those is to learn noise by heart.
size_t rank_above(const Spectrum& spectrum, float smallest);

/// Ranks are padded to this by eigenvalues of 0.
inline constexpr uint32_t kRankLanes = 16;

/// F = A^-1/2 V L V^T A^1/2 with V in 16 bits and all bounces in two small matrices per channel, R
/// being the reflectances. Any number of bounces is one pass over V to r numbers, products of
/// those, and one pass back:
///   k:    E = A^-1/2 V x_k,  x_1 = L t,  x_(k+1) = L (t + M x_k),  M = V^T R V,  t = V^T A^1/2 B
///   all:  E = A^-1/2 V C t,  C = (L^-1 - M)^-1, by the identity of Woodbury.
struct LowRank {
  std::vector<float> root_area_m;                 ///< per patch: A^1/2
  std::vector<int16_t> vector;                    ///< V, patches x rank, patch by patch, no unit
  std::vector<float> eigenvalue;                  ///< L, for these V
  std::array<std::vector<float>, 3> reflected;    ///< M per channel, rank x rank, symmetric
  std::array<std::vector<float>, 3> all_bounces;  ///< C per channel, rank x rank, symmetric

  size_t size() const { return root_area_m.size(); }
  size_t rank() const { return eigenvalue.size(); }  ///< a multiple of kRankLanes
};

/// By the first `rank` eigenvalues, spectrum.count() at most. Reflectances are below 1: light ends.
/// Errors: cancelled.
Result<LowRank> make_low_rank(const Spectrum& spectrum, size_t rank, std::span<const float> area_m2,
                              std::span<const Rgb> reflectance, Progress& progress);

/// Room for one answer.
struct LowRankScratch {
  std::vector<float> partial;           ///< per block of patches: 3 x rank
  std::vector<float> sent, sum, after;  ///< 3 x rank, channel by channel
};
/// Allocates for one answer at a time.
LowRankScratch make_scratch(const LowRank& matrix);

/// Irradiance after `bounces` products (< 0: all) of what patches send on their own; never below
/// zero. Allocates nothing.
void irradiance_of(const LowRank& matrix, std::span<const Rgb> sent, int bounces,
                   std::span<Rgb> irradiance, LowRankScratch& scratch);

/// Bytes of eigenvectors and small matrices.
uint64_t bytes_of(const LowRank& matrix);

}  // namespace luxel::matrix
