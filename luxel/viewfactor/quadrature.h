// Quadrature rules on [0, 1].
#pragma once

#include <span>

namespace luxel::viewfactor {

struct Node {
  double at = 0;      ///< distance from 0
  double to_end = 0;  ///< distance from 1, exact where `at` rounds to 1
  double weight = 0;
};

inline constexpr int kMaxGaussNodes = 24;

/// Gauss and Legendre's rule with `count` nodes, 1 to kMaxGaussNodes: exact for polynomials of
/// degree 2 count - 1.
std::span<const Node> gauss_rule(int count);

/// The rule for a function that is analytic on the interval, with its nearest singularity in the
/// complex plane `rho` away, measured by the sum of the half axes of the Bernstein ellipse through
/// it: n nodes leave an error of rho^-2n [Trefethen08, theorem 4.5]. Returns the number of nodes
/// for a relative error of `tolerance`; more than kMaxGaussNodes when the rule is unfit.
int gauss_nodes_for(double rho, double tolerance);

/// The tanh-sinh (double exponential) rule, for functions with singularities at the ends of the
/// interval [Takahasi74]. `coarse` serves where the ends are singular themselves, the other one
/// where a singularity is close to an end but not at it.
enum class TanhSinh { coarse, fine };
std::span<const Node> tanh_sinh_rule(TanhSinh rule);

}  // namespace luxel::viewfactor
