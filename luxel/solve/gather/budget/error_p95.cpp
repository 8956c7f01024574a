#include "luxel/solve/gather/budget/error_p95.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace luxel::gather {
namespace {

/// The share of elements that may err by more.
constexpr double kBeyond = 0.05;
/// Standard errors are counted by their logarithm: elements of a bin differ by 4.4 % at most, and
/// are taken for as many with the bin's mean.
constexpr int kBinsPerOctave = 16, kOctaves = 64;

struct Bin {
  double sum = 0, count = 0;
};

size_t bin_of(float s) {
  const float octave = std::log2(s) + 0.5f * float(kOctaves);
  return size_t(std::clamp(int(octave * kBinsPerOctave), 0, kBinsPerOctave * kOctaves - 1));
}

}  // namespace

float error_p95(std::span<const float> standard_errors, const std::function<bool(size_t)>& counts) {
  std::array<Bin, size_t(kBinsPerOctave) * kOctaves> bins{};
  double all = 0;
  float largest = 0;
  for (size_t i = 0; i < standard_errors.size(); ++i) {
    if (counts && !counts(i)) continue;
    all += 1;
    const float s = standard_errors[i];
    if (!(s > 0)) continue;
    Bin& bin = bins[bin_of(s)];
    bin.sum += double(s), bin.count += 1;
    largest = std::max(largest, s);
  }
  const auto beyond = [&](double x) {
    double sum = 0;
    for (const Bin& b : bins)
      if (b.count > 0) sum += b.count * std::erfc(x * b.count / (b.sum * std::sqrt(2.0)));
    return sum;
  };
  // 95 % of all lie within 1.96 times the largest.
  double low = 0, high = 2 * double(largest);
  constexpr int kHalvings = 40;
  for (int k = 0; k < kHalvings; ++k) {
    const double x = 0.5 * (low + high);
    (beyond(x) > kBeyond * all ? low : high) = x;
  }
  return float(high);
}

}  // namespace luxel::gather
