// The matrix of form factors between patches, by rays, as a sparse matrix.
#pragma once

#include "luxel/base/progress.h"
#include "luxel/base/team.h"
#include "luxel/scene/scene.h"
#include "luxel/solve/matrix/patches.h"

namespace luxel::matrix {

/// Row i holds F_ij, the share of what patch i radiates that reaches patch j, for every j it sees;
/// rows one after another, columns ascending.
struct FormFactors {
  std::vector<uint64_t> first;  ///< per row, one extra entry
  std::vector<uint32_t> column;
  std::vector<float> factor;

  /// The number of patches, that is rows.
  size_t size() const { return first.size() - 1; }
  /// The patches that a row's patch sees, ascending.
  std::span<const uint32_t> columns_of(size_t row) const {
    return {column.data() + first[row], size_t(first[row + 1] - first[row])};
  }
  /// F for each of columns_of(row).
  std::span<const float> factors_of(size_t row) const {
    return {factor.data() + first[row], size_t(first[row + 1] - first[row])};
  }
};

/// Settings of the rays that look for form factors.
struct FactorParams {
  int rays_per_patch = 2048;  ///< cosine-distributed, from the patch's points
  uint64_t seed = 1;
};

/// Form factors as rays found them, not yet reciprocal.
struct TracedFactors {
  FormFactors factors;
  std::vector<float> sky;  ///< per patch: the share of rays that leave the scene
  uint64_t rays = 0;
};

/// F_ij = the share of rays from i that meet the patch j first. The standard error of a factor is
/// at most sqrt(F / rays), and that of the light gathered over many patches far less. Backs of
/// one-sided surfaces send nothing. Members of a team share the patches out. Errors: cancelled,
/// another member of the team gives up.
Result<TracedFactors> trace_factors(const scene::Scene& scene, const trace::RayTracer& tracer,
                                    const PatchedScene& patched, const FactorParams& params,
                                    Progress& progress, Team* team = nullptr);

/// Makes A_i F_ij = A_j F_ji: both are estimates of the same exchange, so their mean has less
/// noise. Then scales S_ij = A_i F_ij to d_i S_ij d_j so that each row has the sum that its rays
/// found, which is at most 1 and known far better than any factor [Knight13], as far as it can
/// have; rows never sum to more than 1.
FormFactors reciprocal(const FormFactors& traced, std::span<const float> area_m2);

/// The share of what patch `row` radiates that reaches any other: 1 in a closed room.
double row_sum(const FormFactors& factors, size_t row);

/// E = F B, row by row.
void multiply(const FormFactors& factors, std::span<const Rgb> radiosity,
              std::span<Rgb> irradiance);

}  // namespace luxel::matrix
