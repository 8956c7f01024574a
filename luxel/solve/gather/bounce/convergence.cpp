#include "luxel/solve/gather/bounce/convergence.h"

#include <algorithm>
#include <cmath>

namespace luxel::gather {

ReflectanceRange reflectance_range(const transport::Elements& elements) {
  ReflectanceRange range;
  for (size_t i = 0; i < elements.size(); ++i) {
    const Rgb tau = elements.transmittance.empty() ? Rgb{} : elements.transmittance[i];
    const Rgb rho = elements.reflectance[i] + tau;
    range.mean += double(luminance(rho)) / double(elements.size());
    range.max = std::max(range.max, double(max_component(rho)));
  }
  return range;
}

double sweeps_of_later_stride(double ratio) {
  return 1 + std::log(4.0) / -std::log(std::clamp(ratio, 0.1, 0.99));
}

double share_of_sweeps(double done, double left, size_t stride, double ratio) {
  double to_come = left * cost_of_sweep(stride);
  for (const size_t later : kStrides)
    if (later < stride) to_come += sweeps_of_later_stride(ratio) * cost_of_sweep(later);
  return done + to_come > 0 ? done / (done + to_come) : 0;
}

double mean_luminance(std::span<const Rgb> values) {
  double sum = 0;
  for (const Rgb& v : values) sum += double(luminance(v));
  return values.empty() ? 0 : sum / double(values.size());
}

double light_to_come(double change, double ratio, const ReflectanceRange& reflectance) {
  const double seen = ratio > 0 ? ratio : reflectance.max;
  const double q = std::clamp(seen, reflectance.mean, reflectance.max);
  return change * q / (1 - q);
}

}  // namespace luxel::gather
