#include "luxel/viewfactor/factor_matrix.h"

#include <algorithm>
#include <cmath>

namespace luxel::viewfactor {

FactorMatrix empty_factor_matrix(const Surfaces& surfaces) {
  FactorMatrix matrix;
  for (const Surface& surface : surfaces.surfaces) {
    matrix.names.push_back(surface.name);
    matrix.area_m2.push_back(surface.area_m2);
  }
  matrix.factor.assign(matrix.size() * matrix.size(), 0.0);
  matrix.error.assign(matrix.size() * matrix.size(), 0.0);
  return matrix;
}

FactorChecks check_factors(const FactorMatrix& matrix) {
  FactorChecks checks;
  const std::vector<double>& area = matrix.area_m2;
  for (size_t i = 0; i < matrix.size(); ++i) {
    double sum = 0;
    for (size_t j = 0; j < matrix.size(); ++j) sum += matrix.at(i, j);
    checks.row_sum.push_back(sum);
    checks.largest_row_error = std::max(checks.largest_row_error, std::abs(1 - sum));
    for (size_t j = 0; j < i; ++j)
      checks.reciprocity_error =
          std::max(checks.reciprocity_error,
                   std::abs(area[i] * matrix.at(i, j) - area[j] * matrix.at(j, i)) /
                       std::min(area[i], area[j]));
  }
  return checks;
}

}  // namespace luxel::viewfactor
