#include "transport/smooth_factors.h"

#include <Eigen/Core>
#include <Eigen/IterativeLinearSolvers>
#include <algorithm>
#include <cmath>

namespace luxel::transport {
namespace {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

/// Rows further from 1 than this belong to an open scene, where sums of 1 would be wrong.
constexpr double kMostRowError = 0.1;

Matrix symmetric_exchange(const FactorMatrix& matrix) {
  const Eigen::Index n = Eigen::Index(matrix.size());
  Matrix exchange(n, n);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < n; ++j)
      exchange(i, j) = 0.5 * (matrix.area_m2[size_t(i)] * matrix.at(size_t(i), size_t(j)) +
                              matrix.area_m2[size_t(j)] * matrix.at(size_t(j), size_t(i)));
  return exchange;
}

/// Lagrange's conditions: X'_ij = X_ij + W_ij (l_i + l_j), with multipliers l such that rows sum to
/// the areas:   (diag(row sums of W) + W) l = A - row sums of X.      W = X here, so that
///   => X'_ij = X_ij (1 + l_i + l_j)
Matrix corrected(const Matrix& exchange, const Vector& areas) {
  Matrix system = exchange;
  system.diagonal() += exchange.rowwise().sum();
  Eigen::ConjugateGradient<Matrix, Eigen::Lower | Eigen::Upper> solver;
  solver.setTolerance(1e-15);
  solver.compute(system);
  const Vector multiplier = solver.solve(areas - exchange.rowwise().sum());
  Matrix out = exchange;
  for (Eigen::Index i = 0; i < out.rows(); ++i)
    for (Eigen::Index j = 0; j < out.cols(); ++j) out(i, j) *= 1 + multiplier(i) + multiplier(j);
  return out;
}

double largest_relative_residual(const Matrix& exchange, const Vector& areas) {
  return ((exchange.rowwise().sum() - areas).array() / areas.array()).abs().maxCoeff();
}

}  // namespace

Result<double> smooth_factors(FactorMatrix& matrix) {
  const FactorChecks checks = check_factors(matrix);
  for (size_t i = 0; i < matrix.size(); ++i)
    if (std::abs(1 - checks.row_sum[i]) > kMostRowError)
      return fail(ErrorCode::bad_input,
                  "the factors from surface '{}' sum to {:.4g}: only the factors of a closed "
                  "enclosure, with sums between {} and {}, can be smoothed",
                  matrix.names[i], checks.row_sum[i], 1 - kMostRowError, 1 + kMostRowError);
  const Vector areas = Eigen::Map<const Vector>(matrix.area_m2.data(), Eigen::Index(matrix.size()));
  Matrix exchange = symmetric_exchange(matrix);
  // Factors that would turn negative become zero, and the others share what that leaves; once or
  // twice is enough.
  constexpr int kMostRounds = 8;
  for (int round = 0; round < kMostRounds; ++round) {
    exchange = corrected(exchange, areas);
    if ((exchange.array() >= 0).all() && largest_relative_residual(exchange, areas) < 1e-13) break;
    exchange = exchange.cwiseMax(0.0);
  }
  if (!(largest_relative_residual(exchange, areas) < 1e-9))
    return fail(ErrorCode::bad_input,
                "no symmetric matrix of factors near this one has rows that sum to 1; the surfaces "
                "do not form one closed enclosure");
  double change = 0;
  for (size_t i = 0; i < matrix.size(); ++i)
    for (size_t j = 0; j < matrix.size(); ++j) {
      const double factor = exchange(Eigen::Index(i), Eigen::Index(j)) / matrix.area_m2[i];
      change = std::max(change, std::abs(factor - matrix.at(i, j)));
      matrix.at(i, j) = factor;
    }
  return change;
}

}  // namespace luxel::transport
