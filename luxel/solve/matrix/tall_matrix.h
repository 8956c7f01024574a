// Matrices of patches x a few hundred: what the spectrum of a large matrix is found with. Sums over
// patches are taken per fixed block, in block order.
#pragma once

#include <Eigen/Core>

#include "luxel/base/progress.h"

namespace luxel::matrix {

/// A row per patch.
using Tall = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// a^T b, in double precision. What a cancelled call returns means nothing.
Eigen::MatrixXd inner_products(const Tall& a, const Tall& b, const Progress& progress);

/// a m. What a cancelled call leaves means nothing.
Tall combine(const Tall& a, const Eigen::MatrixXd& m, const Progress& progress);

/// An orthonormal basis of what the columns of `a` span, fewer columns where they depend on each
/// other up to rounding: Cholesky's method with pivots on a^T a, twice, because once is only nearly
/// orthogonal [Yamamoto15]. Rotates in parallel, and can be cancelled between rows, unlike
/// Householder's.
Tall orthonormal(const Tall& a, const Progress& progress);

}  // namespace luxel::matrix
