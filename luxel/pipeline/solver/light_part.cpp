#include "luxel/pipeline/solver/light_part.h"

#include "luxel/base/check.h"
#include "luxel/base/free_memory.h"
#include "luxel/solve/gather/budget/error_p95.h"

namespace luxel::pipeline {
namespace {

double mean_luminance(std::span<const Rgb> light) {
  double sum = 0;
  for (const Rgb& e : light) sum += double(luminance(e));
  return sum / double(std::max<size_t>(light.size(), 1));
}

/// The light that errors are relative to, as in gather::relative_errors().
double denominator(Rgb light, double mean) {
  return std::max(double(luminance(light)), 0.1 * mean);
}

/// a - b: a difference of rounded sums may fall below zero.
void subtract(std::span<const Rgb> b, std::span<Rgb> a) {
  for (size_t i = 0; i < a.size(); ++i) a[i] = max(a[i] - b[i], Rgb{});
}

void rescale_errors(std::span<const Rgb> all, TexelLight& light) {
  const double before = mean_luminance(all), after = mean_luminance(light.irradiance);
  if (!(after > 0)) {
    light.errors.assign(light.errors.size(), 0.0f), light.error_p95 = 0, light.relative_error = 0;
    return;
  }
  for (size_t i = 0; i < light.errors.size(); ++i)
    light.errors[i] = float(light.errors[i] * denominator(all[i], before) /
                            denominator(light.irradiance[i], after));
  light.error_p95 = gather::error_p95(
      light.errors, [&](size_t i) { return light.hidden.empty() || !light.hidden[i]; });
  light.relative_error *= before / after;
}

}  // namespace

void take_part(LightPart part, const gather::SourceLight& sources, TexelLight& light) {
  if (part == LightPart::all) return;
  LUXEL_CHECK(sources.punctual.size() == light.irradiance.size());
  const std::vector<Rgb> all = light.irradiance;
  if (part == LightPart::direct) {
    for (size_t i = 0; i < all.size(); ++i)
      light.irradiance[i] = sources.punctual[i] + sources.others[i];
  } else {
    subtract(sources.punctual, light.irradiance);
    if (part == LightPart::indirect) {
      subtract(sources.others, light.irradiance);
      free_memory(light.direct), free_memory(light.direct_variance);
    } else {
      subtract(sources.punctual, light.direct);
    }
  }
  rescale_errors(all, light);
}

}  // namespace luxel::pipeline
