// When sweeps may stop, and which rays they look at until then.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>

#include "luxel/transport/elements.h"

namespace luxel::gather {

/// First every 16th ray is looked at, then every 4th, then all.
inline constexpr std::array<size_t, 3> kStrides{16, 4, 1};
inline constexpr size_t kSparsest = kStrides.front();
/// With fewer than 16 rays looked at of an element its noise is more than later sweeps average out.
inline bool has_sweeps_of(size_t stride, size_t samples) {
  return stride == 1 || samples >= 16 * stride;
}
/// The stride of the first sweeps.
inline size_t sparsest_stride(size_t samples) {
  return *std::ranges::find_if(kStrides, [&](size_t s) { return has_sweeps_of(s, samples); });
}

/// A sweep over every 16th or 4th ray takes longer than that part of one over all rays, which has
/// neighbouring hits at hand: 1.25 to 1.4 times that. (Intel Xeon, 1024 x 1024, four scenes.)
inline double cost_of_sweep(size_t stride) { return stride > 1 ? 1.3 / double(stride) : 1; }
/// Sweeps at each later stride, where each change is `ratio` times the one before: the tolerance is
/// a quarter of that of the stride before, and so has to be what is left; one sweep more averages
/// the noise of the sparser ones.
double sweeps_of_later_stride(double ratio);
/// The part of bounce()'s sweeps without a guess that is done, when `left` sweeps at a stride are
/// expected after `done`, in sweeps over all rays.
double share_of_sweeps(double done, double left, size_t stride, double ratio);

/// The part of the light on both their sides that surfaces send back: its mean and maximum.
struct ReflectanceRange {
  double mean = 0, max = 0;
};
ReflectanceRange reflectance_range(const transport::Elements& elements);

/// The mean that changes are relative to.
double mean_luminance(std::span<const Rgb> values);

/// The sum of all changes still to come when each is q times the one before: change q / (1 - q).
/// The ratio of two changes that follow each other tends to the largest q there is; it is not
/// trusted outside of what the reflectances allow. 0: nothing is known of it.
double light_to_come(double change, double ratio, const ReflectanceRange& reflectance);

}  // namespace luxel::gather
