#include "luxel/validate/stated_errors.h"

#include <algorithm>
#include <cmath>

#include "luxel/transport/elements_at.h"

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

Result<JudgedParts> judge_parts(const Prepared& p, int samples_each, uint64_t seed,
                                Progress& progress) {
  JudgedParts out{atlas::shared_parts(p.atlas, p.map), {}};
  std::vector<scene::SurfacePoint> middles;
  for (const atlas::SharedPart& part : out.parts) middles.push_back(part.middle);
  const transport::Elements places = transport::elements_at(p.scene, middles);
  LUXEL_TRY(out.judged,
            judge(p.scene, *p.tracer, reference::receivers(places), samples_each, seed, progress));
  return out;
}

StatedError stated_error(const pipeline::TexelLight& light, const Judged& judged,
                         const JudgedParts& shared) {
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
  const auto add = [&](double g, const Judged& by, size_t k, double weight) {
    const double a = double(luminance(by.first[k])), b = double(luminance(by.second[k]));
    const double product = (g - a) * (g - b), m = double(luminance(by.standard_error[k]));
    squares += weight * product;
    variance += weight * weight * 4 * m * m * (std::max(0.0, product) + m * m);
  };
  std::vector<double> errors;
  for (const size_t i : texels) {
    const double g = double(luminance(light.irradiance[i]));
    add(g, judged, i, 1 / double(texels.size()));
    const double truth = double(luminance(judged.mean(i))), off = g - truth;
    const double noise = kSurely * double(luminance(judged.standard_error[i]));
    errors.push_back(std::sqrt(std::max(0.0, off * off - noise * noise)) /
                     std::max(truth, 0.1 * mean));
  }
  for (size_t k = 0; k < shared.parts.size(); ++k)
    if (!shared.judged.hidden[k])
      add(double(luminance(light.irradiance[shared.parts[k].texel])), shared.judged, k,
          double(shared.parts[k].area) / double(texels.size()));
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
