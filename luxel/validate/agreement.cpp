#include "luxel/validate/agreement.h"

#include <fmt/format.h>

#include <cmath>

#include "luxel/base/check.h"
#include "luxel/base/random.h"

namespace luxel::validate {

Result<Judged> judge(const Prepared& p, int samples_each, uint64_t seed, Progress& progress) {
  return judge(p.scene, *p.tracer, reference::receivers(p.elements), samples_each, seed, progress);
}

Result<Judged> judge(const scene::Scene& scene, const trace::RayTracer& tracer,
                     const reference::Receivers& receivers, int samples_each, uint64_t seed,
                     Progress& progress) {
  Judged out;
  const auto start = Clock::now();
  reference::PathParams params{.samples = samples_each, .seed = seed};
  LUXEL_TRY(reference::TexelPaths first,
            reference::irradiance_by_paths(scene, receivers, tracer, params, progress));
  params.seed = hash64(seed, 1);
  LUXEL_TRY(reference::TexelPaths second,
            reference::irradiance_by_paths(scene, receivers, tracer, params, progress));
  out.seconds = seconds_since(start);
  out.rays = first.rays + second.rays;
  for (size_t i = 0; i < receivers.size(); ++i) {
    const Rgb a = first.standard_error[i], b = second.standard_error[i];
    const Rgb s2 = a * a + b * b;
    out.standard_error.push_back(0.5f * Rgb{std::sqrt(s2.x), std::sqrt(s2.y), std::sqrt(s2.z)});
    out.hidden.push_back(first.enclosed[i] | second.enclosed[i]);
  }
  out.first = std::move(first.irradiance);
  out.second = std::move(second.irradiance);
  return out;
}

Agreement agreement(std::span<const Rgb> solved, std::span<const uint8_t> solver_hidden,
                    const Judged& judged) {
  LUXEL_CHECK(solved.size() == judged.first.size());
  const auto counts = [&](size_t i) {
    return !judged.hidden[i] && (solver_hidden.empty() || !solver_hidden[i]);
  };
  Agreement out;
  double mean = 0, difference = 0;
  for (size_t i = 0; i < solved.size(); ++i) {
    if (!counts(i)) continue;
    ++out.texels;
    const Rgb truth = judged.mean(i), d = solved[i] - truth;
    mean += double(truth.x) + double(truth.y) + double(truth.z);
    difference += double(d.x) + double(d.y) + double(d.z);
  }
  if (out.texels == 0 || mean <= 0) return out;
  const double n = 3 * double(out.texels), floor = 0.01 * mean / n;
  double squares = 0, squares2 = 0, noise = 0;
  for (size_t i = 0; i < solved.size(); ++i) {
    if (!counts(i)) continue;
    double texel = 0;
    for (const auto c : {&Rgb::x, &Rgb::y, &Rgb::z}) {
      const double g = double(solved[i].*c);
      const double a = double(judged.first[i].*c), b = double(judged.second[i].*c);
      const double scale = std::abs(g) + floor, s = double(judged.standard_error[i].*c);
      texel += (g - a) * (g - b) / (scale * scale);
      noise += s * s / (scale * scale);
    }
    squares += texel, squares2 += texel * texel;
  }
  // NaN and infinity are no agreement.
  if (!std::isfinite(squares)) squares = squares2 = INFINITY;
  out.relative_rmse = std::sqrt(std::max(0.0, squares / n));
  // Channels share their paths: the texel is what is independent.
  const double texels = double(out.texels), mean_texel = squares / texels;
  const double variance = std::max(0.0, squares2 / texels - mean_texel * mean_texel);
  out.resolution = std::sqrt(2 * std::sqrt(variance / texels) / 3);
  out.judge_noise = std::sqrt(noise / n);
  out.bias_over_mean = difference / mean;
  return out;
}

Errors errors_of(std::span<const Rgb> light, std::span<const Rgb> reference,
                 std::span<const uint8_t> hidden) {
  double mean = 0, count = 0;
  for (size_t i = 0; i < reference.size(); ++i)
    if (hidden.empty() || !hidden[i]) mean += double(luminance(reference[i])), count += 1;
  mean /= count;
  Errors e;
  for (size_t i = 0; i < reference.size(); ++i) {
    if (!hidden.empty() && hidden[i]) continue;
    const double d = double(luminance(light[i] - reference[i]));
    const double relative = d / (double(luminance(reference[i])) + 0.01 * mean);
    e.relative += relative * relative / count, e.over_mean += d * d / count, e.mean += d / count;
  }
  return {std::sqrt(e.relative), std::sqrt(e.over_mean) / mean, e.mean / mean};
}

std::string relative_rmse_text(const Agreement& a) {
  return a.relative_rmse < a.resolution ? fmt::format("< {:.2f} %", 100 * a.resolution)
                                        : fmt::format("{:.2f} %", 100 * a.relative_rmse);
}

}  // namespace luxel::validate
