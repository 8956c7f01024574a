#include "luxel/viewfactor/quadrature.h"

#include <array>
#include <cmath>
#include <vector>

#include "luxel/base/check.h"
#include "luxel/base/vec_double.h"

namespace luxel::viewfactor {
namespace {

/// Newton's iteration on the Legendre polynomial, from Tricomi's estimate of its zeros.
std::vector<Node> make_gauss(int count) {
  std::vector<Node> nodes;
  for (int i = 0; i < count; ++i) {
    double x = std::cos(kPiDouble * (i + 0.75) / (count + 0.5)), slope = 1;
    for (int step = 0; step < 20; ++step) {
      double before = 1, value = x;
      for (int k = 2; k <= count; ++k) {
        const double next = ((2 * k - 1) * x * value - (k - 1) * before) / k;
        before = value, value = next;
      }
      slope = count == 1 ? 1 : count * (x * value - before) / (x * x - 1);
      const double change = value / slope;
      x -= change;
      if (std::abs(change) < 1e-16) break;
    }
    nodes.push_back({0.5 * (1 - x), 0.5 * (1 + x), 1 / ((1 - x * x) * slope * slope)});
  }
  return nodes;
}

/// x(t) = 1/2 + 1/2 tanh(pi/2 sinh t), trapezoidal rule in t.
std::vector<Node> make_tanh_sinh(double step) {
  std::vector<Node> nodes;
  const int reach = int(3.3 / step);
  for (int k = -reach; k <= reach; ++k) {
    const double t = k * step, e = std::exp(-kPiDouble * std::sinh(std::abs(t)));
    const double small = e / (1 + e), large = 1 / (1 + e);
    const double weight = step * kPiDouble * std::cosh(t) * e / ((1 + e) * (1 + e));
    nodes.push_back(t < 0 ? Node{small, large, weight} : Node{large, small, weight});
  }
  return nodes;
}

}  // namespace

std::span<const Node> gauss_rule(int count) {
  LUXEL_CHECK(count >= 1 && count <= kMaxGaussNodes);
  static const std::array<std::vector<Node>, kMaxGaussNodes> rules = [] {
    std::array<std::vector<Node>, kMaxGaussNodes> made;
    for (int n = 1; n <= kMaxGaussNodes; ++n) made[size_t(n - 1)] = make_gauss(n);
    return made;
  }();
  return rules[size_t(count - 1)];
}

int gauss_nodes_for(double rho, double tolerance) {
  if (rho <= 1.0001) return kMaxGaussNodes + 1;
  const double needed = std::log(1 / tolerance) / (2 * std::log(rho));
  return needed > kMaxGaussNodes ? kMaxGaussNodes + 1 : std::max(2, int(std::ceil(needed)));
}

std::span<const Node> tanh_sinh_rule(TanhSinh rule) {
  static const std::vector<Node> coarse = make_tanh_sinh(0.12), fine = make_tanh_sinh(0.05);
  return rule == TanhSinh::coarse ? coarse : fine;
}

}  // namespace luxel::viewfactor
