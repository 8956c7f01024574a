#include "luxel/validate/stated_errors.h"

#include <algorithm>
#include <cmath>

namespace luxel::validate {
namespace {

double percentile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  const size_t at = std::min(values.size() - 1, size_t(share * double(values.size())));
  std::nth_element(values.begin(), values.begin() + ptrdiff_t(at), values.end());
  return values[at];
}

}  // namespace

StatedError stated_error(const pipeline::TexelLight& light, const Judged& judged) {
  StatedError out{.stated = light.relative_error, .stated_p95 = double(light.error_p95)};
  std::vector<size_t> texels;
  double mean = 0;
  for (size_t i = 0; i < light.irradiance.size(); ++i) {
    if (judged.hidden[i] || (!light.hidden.empty() && light.hidden[i])) continue;
    texels.push_back(i);
    mean += double(luminance(judged.mean(i)));
  }
  out.texels = texels.size();
  if (texels.empty() || !(mean > 0)) return {};
  mean /= double(texels.size());
  double squares = 0;
  std::vector<double> errors;
  for (const size_t i : texels) {
    const double g = double(luminance(light.irradiance[i]));
    const double a = double(luminance(judged.first[i])), b = double(luminance(judged.second[i]));
    squares += (g - a) * (g - b) / double(texels.size());
    const double off = g - 0.5 * (a + b),
                 noise = 1.96 * double(luminance(judged.standard_error[i]));
    errors.push_back(std::sqrt(std::max(0.0, off * off - noise * noise)) /
                     std::max(0.5 * (a + b), 0.1 * mean));
  }
  out.truth = std::sqrt(std::max(0.0, squares)) / mean;
  out.true_p95 = percentile(std::move(errors), 0.95);
  return out;
}

Held held(Claim claim, std::span<const double> stated, std::span<const double> truth) {
  Held out;
  std::vector<double> ratios;
  for (size_t i = 0; i < stated.size(); ++i) {
    if (!(stated[i] > 0)) continue;
    ++out.scenes;
    const double ratio = truth[i] / stated[i];
    out.holds += claim == Claim::bound ? ratio <= 1
                                       : ratio <= kEstimateFactor && ratio * kEstimateFactor >= 1;
    ratios.push_back(ratio);
  }
  out.middle_ratio = percentile(ratios, 0.5), out.p95_ratio = percentile(ratios, 0.95);
  return out;
}

}  // namespace luxel::validate
