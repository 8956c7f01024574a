// Small corrections after which a matrix of view factors keeps its laws.
#pragma once

#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/viewfactor/factor_matrix.h"

namespace luxel::viewfactor {

/// Replaces the exchange areas X_ij = A_i F_ij of a closed enclosure by the nearest ones that are
/// symmetric, not negative, and whose rows sum to the areas A_i. "Nearest" is weighted least
/// squares: sum (X'_ij - X_ij)^2 / W_ij with W_ij the symmetric mean of X_ij and X_ji, so that
/// small factors change little and zeros stay zeros [Larsen86; vanLeersum89]. Returns the largest
/// change of a factor. Needs one more table of doubles beside the matrix. Errors: cancelled, and
/// bad_input: the enclosure is so far from closed, or so sparse, that no such matrix is near.
Result<double> smooth_factors(FactorMatrix& matrix, Progress& progress);

}  // namespace luxel::viewfactor
