#include "luxel/solve/gather/rays/cell_guide.h"

#include <algorithm>
#include <cmath>

#include "luxel/base/vectorize.h"

namespace luxel::gather {
namespace {

/// Variances of a cell's mean fall like n_c^-kFall (docs/method/gather.md).
constexpr double kFall = 1.4;

/// The nearest whole number that there may be.
inline int doublings_of(float doublings, float shift) {
  return int(std::clamp(doublings + shift + 0.5f, 0.0f, float(kMostDoublings) + 0.5f));
}

/// Rays of an element with a sample in each cell that has no doublings.
LUXEL_VECTOR_CLONES
uint32_t rays_with(const float* doublings, float shift) {
  uint32_t sum = 0;
  for (size_t c = 0; c < kCells; ++c) sum += 1u << doublings_of(doublings[c], shift);
  return sum;
}

/// The shift with as many rays as that, or a few less: rays grow with the shift.
float shift_for(uint32_t rays, const GuidedGroup& group) {
  float low = -*std::ranges::max_element(group.doublings),
        high = float(kMostDoublings) - *std::ranges::min_element(group.doublings);
  constexpr int kSteps = 16;
  for (int step = 0; step < kSteps; ++step) {
    const float middle = 0.5f * (low + high);
    (rays_with(group.doublings.data(), middle) > rays ? high : low) = middle;
  }
  return low;
}

/// The part of the variance that is left of that of equal shares.
float left_with(const GuidedGroup& group, std::span<const float, kCells> deviations, float shift) {
  static const auto left_after = [] {
    std::array<float, kMostDoublings + 1> out;
    for (int k = 0; k <= kMostDoublings; ++k) out[size_t(k)] = float(std::exp2(-kFall * k));
    return out;
  }();
  double equal = 0, left = 0;
  for (size_t c = 0; c < kCells; ++c) {
    const double variance = double(deviations[c]) * double(deviations[c]);
    equal += variance;
    left += variance * double(left_after[size_t(doublings_of(group.doublings[c], shift))]);
  }
  return equal > 0 ? float(left / equal) : 1.0f;
}

}  // namespace

GuidedGroup guided_group(std::span<const float, kCells> deviations) {
  GuidedGroup out;
  const float most = *std::ranges::max_element(deviations);
  // A cell with 2^-20 of the largest deviation has no more than one ray at any level.
  const double least = std::max(double(most) * 1e-6, 1e-30);
  for (size_t c = 0; c < kCells; ++c)
    out.doublings[c] = float(std::log2(std::max(double(deviations[c]), least)) * (2 / (1 + kFall)));
  for (int level = 1; level <= kGuideLevels; ++level) {
    const float shift = shift_for(uint32_t(double(kCells) * std::exp2(0.5 * level)), out);
    out.levels[size_t(level - 1)] = {shift, float(rays_with(out.doublings.data(), shift)),
                                     left_with(out, deviations, shift)};
  }
  return out;
}

CellShares shares_at(const GuidedGroup& group, int level) {
  CellShares out;
  for (size_t c = 0; c < kCells; ++c)
    out.doublings[c] = uint8_t(doublings_of(group.doublings[c], group.level(level).shift));
  return out;
}

}  // namespace luxel::gather
