#include "luxel/pipeline/solver/upper_mean.h"

#include <cmath>

namespace luxel::pipeline {
namespace {

/// Quantile of the normal distribution: 97.7 %.
constexpr double kUpperQuantile = 2;

}  // namespace

double upper_mean(std::span<const double> draws) {
  if (draws.empty()) return 0;
  const auto n = double(draws.size());
  double mean = 0, second = 0, third = 0;
  for (const double x : draws) mean += x / n;
  for (const double x : draws) {
    const double d = x - mean;
    second += d * d / n, third += d * d * d / n;
  }
  if (!(second > 0)) return mean;
  const double z = kUpperQuantile, skewness = third / (second * std::sqrt(second));
  return mean + std::sqrt(second / n) * (z + skewness * (2 * z * z + 1) / (6 * std::sqrt(n)));
}

}  // namespace luxel::pipeline
