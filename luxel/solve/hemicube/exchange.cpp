#include "luxel/solve/hemicube/exchange.h"

#include <algorithm>
#include <cmath>

namespace luxel::hemicube {
namespace {

/// As many as light::direct_light computes exactly, each for itself.
constexpr size_t kMaxExactLights = 32;
/// With rho = 0.99 the light to come falls below 1e-4 after 1,400 passes.
constexpr int kMaxSweeps = 4000;

/// Root mean squares over elements with area, weighted with it; vertices of flat triangles have
/// none, and no light.
double mean_luminance(const Receivers& r, std::span<const Rgb> values) {
  double sum = 0, area = 0;
  for (size_t i = 0; i < values.size(); ++i)
    sum += double(luminance(values[i])) * r.area_m2[i], area += r.area_m2[i];
  return area > 0 ? sum / area : 0;
}

double rms_change(const Receivers& r, std::span<const Rgb> a, std::span<const Rgb> b) {
  double sum = 0, area = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    const Rgb d = a[i] - b[i];
    sum += double(dot(d, d)) / 3 * r.area_m2[i], area += r.area_m2[i];
  }
  return area > 0 ? std::sqrt(sum / area) : 0;
}

/// The sum of all changes still to come when each is q times the one before, q being the ratio of
/// the last two; no larger than the largest reflectance.
double light_to_come(double change, double before, double largest_reflectance) {
  const double q =
      before > 0 ? std::min(change / before, largest_reflectance) : largest_reflectance;
  return change * q / (1 - q);
}

}  // namespace

Emission choose_emission(const light::Lights& lights) {
  Emission out{lights.emissive_triangles > kMaxExactLights, lights};
  if (!out.by_pixels) return out;
  out.exact.triangles.clear(), out.exact.nodes.clear();
  return out;
}

std::vector<Rgb> radiosity(const transport::Elements& elements, std::span<const Rgb> irradiance) {
  std::vector<Rgb> out(irradiance.size());
  for (size_t i = 0; i < out.size(); ++i) out[i] = elements.reflectance[i] * irradiance[i];
  return out;
}

Result<Exchanged> exchange(const Receivers& receivers, const Rows& rows,
                           std::span<const Rgb> source, const RefillPlan& plan,
                           std::span<const Rgb> start, const ExchangeParams& params,
                           Progress& progress) {
  Exchanged out;
  const std::span<const Rgb> first = !start.empty() && params.bounces < 0 ? start : source;
  out.irradiance.assign(first.begin(), first.end());
  refill(plan, out.irradiance);
  float largest = 0;
  for (const Rgb& rho : receivers.elements.reflectance)
    largest = std::max(largest, max_component(rho));
  std::vector<Rgb> next(receivers.size());
  double before = 0;
  const int sweeps = params.bounces < 0 ? kMaxSweeps : params.bounces;
  progress.begin("bounces", 0);
  while (out.sweeps < sweeps) {
    const std::vector<Rgb> sent = radiosity(receivers.elements, out.irradiance);
    LUXEL_TRY_STATUS(sweep(rows, source, sent, next, progress));
    refill(plan, next);
    const double change = rms_change(receivers, next, out.irradiance);
    out.irradiance.swap(next);
    ++out.sweeps;
    progress.advance(1);
    if (params.on_bounce) params.on_bounce(out.irradiance);
    const double mean = mean_luminance(receivers, out.irradiance);
    if (params.bounces < 0 &&
        light_to_come(change, before, double(largest)) <= double(params.tolerance) * mean)
      break;
    before = change;
  }
  return out;
}

}  // namespace luxel::hemicube
