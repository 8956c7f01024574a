#include "luxel/solve/matrix/tall_matrix.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

#include "luxel/base/check.h"
#include "luxel/base/parallel.h"

namespace luxel::matrix {
namespace {

/// Blocks whose sums are kept apart; few, because each is a matrix.
constexpr Eigen::Index kBlocks = 16;
/// Rows between two looks at whether to stop.
constexpr Eigen::Index kTallRows = 256;
/// The least pivot that counts, as a part of the largest one. Pivots are squares of lengths:
/// columns of 32-bit floats, which are rounded by 6e-8, differ by no more than noise below
/// sqrt(1e-11) = 3e-6.
constexpr double kSmallestPivot = 1e-11;

/// m such that a m is orthonormal, a^T a being `gram`. Eigen's own pivots look at the diagonal as
/// it was, not at what is left of it, and so do not tell what depends.
Eigen::MatrixXd orthonormalising(const Eigen::MatrixXd& gram) {
  const Eigen::Index size = gram.rows();
  Eigen::MatrixXd lower = Eigen::MatrixXd::Zero(size, size);  // gram = lower lower^T, rows in place
  Eigen::VectorXd left = gram.diagonal();
  const double smallest = kSmallestPivot * (size > 0 ? left.maxCoeff() : 0.0);
  std::vector<Eigen::Index> chosen;
  for (Eigen::Index k = 0; k < size; ++k) {
    Eigen::Index pivot = 0;
    if (!(left.maxCoeff(&pivot) > smallest)) break;
    lower.col(k) = gram.col(pivot) - lower.leftCols(k) * lower.row(pivot).head(k).transpose();
    lower.col(k) /= std::sqrt(left[pivot]);
    left -= lower.col(k).cwiseAbs2();
    left[pivot] = 0;
    chosen.push_back(pivot);
  }
  const auto rank = Eigen::Index(chosen.size());
  const Eigen::MatrixXd triangle = lower(chosen, Eigen::seqN(0, rank));
  Eigen::MatrixXd m = Eigen::MatrixXd::Zero(size, rank);
  const Eigen::MatrixXd inverse = triangle.transpose().triangularView<Eigen::Upper>().solve(
      Eigen::MatrixXd::Identity(rank, rank));
  m(chosen, Eigen::all) = inverse;
  return m;
}

Tall orthonormal_once(const Tall& a, const Progress& progress) {
  const Eigen::MatrixXd gram = inner_products(a, a, progress);
  if (progress.cancelled()) return a;
  return combine(a, orthonormalising(gram), progress);
}

}  // namespace

Eigen::MatrixXd inner_products(const Tall& a, const Tall& b, const Progress& progress) {
  LUXEL_CHECK(a.rows() == b.rows());
  const Eigen::Index rows_per_block = (a.rows() + kBlocks - 1) / kBlocks;
  std::vector<Eigen::MatrixXd> sums(size_t(kBlocks), Eigen::MatrixXd::Zero(a.cols(), b.cols()));
  parallel_for(size_t(kBlocks), 1, [&](size_t begin, size_t end) {
    for (auto block = Eigen::Index(begin); block < Eigen::Index(end); ++block) {
      const Eigen::Index stop = std::min(a.rows(), (block + 1) * rows_per_block);
      for (Eigen::Index i = block * rows_per_block; i < stop && !progress.cancelled();
           i += kTallRows) {
        const Eigen::Index rows = std::min(kTallRows, stop - i);
        sums[size_t(block)].noalias() +=
            a.middleRows(i, rows).cast<double>().transpose() * b.middleRows(i, rows).cast<double>();
      }
    }
  });
  for (size_t block = 1; block < sums.size(); ++block) sums[0] += sums[block];
  return std::move(sums[0]);
}

Tall combine(const Tall& a, const Eigen::MatrixXd& m, const Progress& progress) {
  LUXEL_CHECK(a.cols() == m.rows());
  Tall out(a.rows(), m.cols());
  parallel_for(size_t(a.rows()), size_t(kTallRows), [&](size_t begin, size_t end) {
    if (progress.cancelled()) return;
    const auto first = Eigen::Index(begin), rows = Eigen::Index(end - begin);
    out.middleRows(first, rows) = (a.middleRows(first, rows).cast<double>() * m).cast<float>();
  });
  return out;
}

Tall orthonormal(const Tall& a, const Progress& progress) {
  return orthonormal_once(orthonormal_once(a, progress), progress);
}

}  // namespace luxel::matrix
