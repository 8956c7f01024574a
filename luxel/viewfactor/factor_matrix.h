// View factors between the surfaces of a scene.
#pragma once

#include <string>
#include <vector>

#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/base/team.h"
#include "luxel/viewfactor/surfaces.h"

namespace luxel::viewfactor {

/// F(i -> j): the fraction of what surface i radiates diffusely that arrives at the front of j
/// without a bounce. What hits a back or nothing is in no column.
struct FactorMatrix {
  std::vector<std::string> names;
  std::vector<double> area_m2;
  std::vector<double> factor;  ///< row i, column j at i * size() + j
  std::vector<double> error;   ///< estimated absolute error (analytic) or standard error (sampled)
  std::vector<std::string> warnings;  ///< pairs whose error is larger than asked for

  /// The number of surfaces.
  size_t size() const { return area_m2.size(); }
  /// F(i -> j).
  double& at(size_t i, size_t j) { return factor[i * size() + j]; }
  /// F(i -> j).
  double at(size_t i, size_t j) const { return factor[i * size() + j]; }
};
/// The surfaces' names and areas, all factors and errors 0.
FactorMatrix empty_factor_matrix(const Surfaces& surfaces);

/// The entries that are asked for; kNone: all rows or all columns. Others stay 0.
struct FactorSelection {
  uint32_t from = scene::kNone, to = scene::kNone;
};

/// Deviations of the matrix from the sum rule and from reciprocity.
struct FactorChecks {
  std::vector<double> row_sum;
  double largest_row_error = 0;  ///< |1 - row sum|: 0 when the surfaces close a room
  double reciprocity_error = 0;  ///< largest |A_i F_ij - A_j F_ji| / min(A_i, A_j)
};
/// Measures a whole matrix.
FactorChecks check_factors(const FactorMatrix& matrix);

/// Accuracy of factors past blockers, and a bound on the work.
struct AnalyticParams {
  /// Relative error of pairs of polygons with something between them; of factors below 1e-3 of the
  /// smaller polygon, the error of one of that size.
  double tolerance = 1e-4;
  uint32_t max_cells = 1u << 17;  ///< pieces of a pair of polygons after which its work ends
};
/// In closed form, past blockers by subdivision (visible_form_factor.h). Each pair is computed once
/// and serves both directions. A pair of surfaces in which max_cells ended the work leaves a
/// warning that names it and the error reached. Members of a team share pairs out. Errors:
/// cancelled, another member of the team gives up.
Result<FactorMatrix> analytic_factors(const Surfaces& surfaces, const AnalyticParams& params,
                                      const FactorSelection& selection, Progress& progress,
                                      Team* team = nullptr);

}  // namespace luxel::viewfactor
