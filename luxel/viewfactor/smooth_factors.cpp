#include "luxel/viewfactor/smooth_factors.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "luxel/base/parallel.h"

namespace luxel::viewfactor {
namespace {

using Vector = std::vector<double>;

/// Rows further from 1 than this belong to an open scene, where sums of 1 would be wrong.
constexpr double kMostRowError = 0.1;

/// A symmetric table of exchange areas [m^2], row by row.
struct Exchange {
  size_t size = 0;
  Vector value;
  std::span<double> row(size_t i) { return {&value[i * size], size}; }
  std::span<const double> row(size_t i) const { return {&value[i * size], size}; }
};

/// Calls body(i) for every row, on all threads, until the work is cancelled.
template <class Body>
void for_rows(const Exchange& exchange, const Progress& progress, const Body& body) {
  parallel_for(exchange.size, 16, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end && !progress.cancelled(); ++i) body(i);
  });
}

Exchange symmetric_exchange(const FactorMatrix& matrix, const Progress& progress) {
  Exchange exchange{matrix.size(), Vector(matrix.size() * matrix.size())};
  for_rows(exchange, progress, [&](size_t i) {
    for (size_t j = 0; j < exchange.size; ++j)
      exchange.row(i)[j] =
          0.5 * (matrix.area_m2[i] * matrix.at(i, j) + matrix.area_m2[j] * matrix.at(j, i));
  });
  return exchange;
}

Vector row_sums(const Exchange& exchange, const Progress& progress) {
  Vector sums(exchange.size);
  for_rows(exchange, progress, [&](size_t i) {
    for (const double x : exchange.row(i)) sums[i] += x;
  });
  return sums;
}

double product(const Vector& a, const Vector& b) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

/// Solves (diag(sums) + X) l = right by conjugate gradients, preconditioned with the diagonal. The
/// matrix is semidefinite; where it is singular (light goes only to and fro between two halves)
/// the right side is in its range, and the solution that starts from 0 is as good as any.
Vector multipliers(const Exchange& exchange, const Vector& sums, const Vector& right,
                   const Progress& progress) {
  constexpr int kMostSteps = 1000, kMostIdle = 50;
  const size_t n = exchange.size;
  Vector solution(n), rest = right, scaled(n), step(n), image(n);
  const auto precondition = [&] {
    for (size_t i = 0; i < n; ++i) {
      const double diagonal = sums[i] + exchange.row(i)[i];
      scaled[i] = diagonal > 0 ? rest[i] / diagonal : 0;
    }
  };
  precondition();
  step = scaled;
  double along = product(rest, scaled), least = product(rest, rest);
  const double enough = 1e-30 * least;
  for (int k = 0, idle = 0; k < kMostSteps && idle < kMostIdle && along > 0; ++k, ++idle) {
    for_rows(exchange, progress, [&](size_t i) {
      image[i] = sums[i] * step[i];
      for (size_t j = 0; j < n; ++j) image[i] += exchange.row(i)[j] * step[j];
    });
    const double curvature = product(step, image);
    if (!(curvature > 0) || progress.cancelled()) break;
    const double length = along / curvature;
    for (size_t i = 0; i < n; ++i) solution[i] += length * step[i], rest[i] -= length * image[i];
    const double left = product(rest, rest);
    if (left <= enough) break;
    if (left < least) least = left, idle = 0;
    precondition();
    const double next = product(rest, scaled);
    for (size_t i = 0; i < n; ++i) step[i] = scaled[i] + next / along * step[i];
    along = next;
  }
  return solution;
}

/// Lagrange's conditions: X'_ij = X_ij + W_ij (l_i + l_j), with multipliers l such that rows sum to
/// the areas:   (diag(row sums of W) + W) l = A - row sums of X.      W = X here, so that
///   => X'_ij = X_ij (1 + l_i + l_j)
/// Entries that would turn negative become 0. Returns whether there were none.
bool correct(Exchange& exchange, const Vector& areas, const Progress& progress) {
  const Vector sums = row_sums(exchange, progress);
  Vector missing(areas);
  for (size_t i = 0; i < missing.size(); ++i) missing[i] -= sums[i];
  const Vector l = multipliers(exchange, sums, missing, progress);
  std::vector<uint8_t> cut(exchange.size);
  for_rows(exchange, progress, [&](size_t i) {
    for (size_t j = 0; j < exchange.size; ++j) {
      double& x = exchange.row(i)[j];
      x *= 1 + (l[i] + l[j]);
      if (x < 0) x = 0, cut[i] = 1;
    }
  });
  return std::find(cut.begin(), cut.end(), 1) == cut.end();
}

double largest_relative_residual(const Exchange& exchange, const Vector& areas,
                                 const Progress& progress) {
  const Vector sums = row_sums(exchange, progress);
  double largest = 0;
  for (size_t i = 0; i < areas.size(); ++i)
    largest = std::max(largest, std::abs(sums[i] - areas[i]) / areas[i]);
  return largest;
}

}  // namespace

Result<double> smooth_factors(FactorMatrix& matrix, Progress& progress) {
  progress.begin("smooth", 0);
  const FactorChecks checks = check_factors(matrix);
  for (size_t i = 0; i < matrix.size(); ++i)
    if (std::abs(1 - checks.row_sum[i]) > kMostRowError)
      return fail(ErrorCode::bad_input,
                  "the factors from surface '{}' sum to {:.4g}: only the factors of a closed "
                  "enclosure, with sums between {} and {}, can be smoothed",
                  matrix.names[i], checks.row_sum[i], 1 - kMostRowError, 1 + kMostRowError);
  Exchange exchange = symmetric_exchange(matrix, progress);
  // Factors that would turn negative become zero, and the others share what that leaves; once or
  // twice is enough.
  constexpr int kMostRounds = 8;
  double residual = INFINITY;
  for (int round = 0; round < kMostRounds && !progress.cancelled(); ++round) {
    const bool is_whole = correct(exchange, matrix.area_m2, progress);
    residual = largest_relative_residual(exchange, matrix.area_m2, progress);
    if (is_whole && residual < 1e-13) break;
  }
  LUXEL_TRY_STATUS(stopped(progress));
  if (!(residual < 1e-9))
    return fail(ErrorCode::bad_input,
                "no symmetric matrix of factors near this one has rows that sum to 1; the surfaces "
                "do not form one closed enclosure");
  double change = 0;
  for (size_t i = 0; i < matrix.size(); ++i)
    for (size_t j = 0; j < matrix.size(); ++j) {
      const double factor = exchange.row(i)[j] / matrix.area_m2[i];
      change = std::max(change, std::abs(factor - matrix.at(i, j)));
      matrix.at(i, j) = factor;
    }
  return change;
}

}  // namespace luxel::viewfactor
