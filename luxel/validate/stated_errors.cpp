#include "luxel/validate/stated_errors.h"

#include <algorithm>
#include <cmath>

namespace luxel::validate {
namespace {

/// Standard errors within which a normal value lies in 95 of 100 cases.
constexpr double kSurely = 1.96;

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
  // With D = g - truth and the variance 2 m^2 of either answer, m being the standard error of their
  // mean, (g - a)(g - b) has the mean D^2 and the variance 4 m^2 D^2 + 4 m^4.
  double squares = 0, variance = 0;
  std::vector<double> errors;
  for (const size_t i : texels) {
    const double g = double(luminance(light.irradiance[i]));
    const double a = double(luminance(judged.first[i])), b = double(luminance(judged.second[i]));
    const double off = g - 0.5 * (a + b), product = (g - a) * (g - b);
    const auto m = double(luminance(judged.standard_error[i]));
    squares += product / double(texels.size());
    variance += 4 * m * m * (std::max(0.0, product) + m * m) /
                (double(texels.size()) * double(texels.size()));
    const double noise = kSurely * m;
    errors.push_back(std::sqrt(std::max(0.0, off * off - noise * noise)) /
                     std::max(0.5 * (a + b), 0.1 * mean));
  }
  const auto rms = [&](double square) { return std::sqrt(std::max(0.0, square)) / mean; };
  const double unsure = kSurely * std::sqrt(variance);
  out.truth = rms(squares);
  out.truth_low = rms(squares - unsure), out.truth_high = rms(squares + unsure);
  out.true_p95 = percentile(std::move(errors), 0.95);
  return out;
}

Held held(Claim claim, std::span<const Compared> entries) {
  Held out;
  std::vector<double> ratios;
  for (const Compared& c : entries) {
    if (!(c.stated > 0)) continue;
    ++out.scenes;
    out.holds += claim == Claim::bound
                     ? c.low <= c.stated
                     : c.low <= kEstimateFactor * c.stated && kEstimateFactor * c.high >= c.stated;
    ratios.push_back(c.truth / c.stated);
  }
  out.middle_ratio = percentile(ratios, 0.5), out.p95_ratio = percentile(ratios, 0.95);
  return out;
}

}  // namespace luxel::validate
