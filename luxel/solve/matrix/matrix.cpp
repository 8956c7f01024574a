#include "luxel/solve/matrix/matrix.h"

#include <algorithm>
#include <cmath>

#include "luxel/base/check.h"
#include "luxel/base/parallel.h"
#include "luxel/light/direct_light.h"
#include "luxel/solve/matrix/probes.h"

namespace luxel::matrix {
namespace {

/// The visible share of a light is a ratio of sums, which few shadow rays overestimate: 16 by 0.2
/// %.
constexpr int kLeastSamples = 64;
/// Rays per probe towards a map of the surroundings: with eight probes, 1,024 per patch.
constexpr int kSkySamples = 128;
constexpr int kMaxSweeps = 4000;

double mean_square(std::span<const Rgb> values, std::span<const float> area_m2) {
  double sum = 0, area = 0;
  for (size_t i = 0; i < values.size(); ++i) {
    sum += double(dot(values[i], values[i])) * double(area_m2[i]) / 3;
    area += double(area_m2[i]);
  }
  return area > 0 ? sum / area : 0;
}

/// The sum of all changes still to come when each is q times the one before.
double light_to_come(double change, double before, double largest_reflectance) {
  const double q =
      before > 0 ? std::min(change / before, largest_reflectance) : largest_reflectance;
  return change * q / (1 - q);
}

/// Root mean square of the standard errors that independent rays would have, over the mean light:
/// of each ray the variance of what it sees. The rays are stratified, so it is less.
double ray_error(const Prepared& prepared, const Solution& solution, int rays) {
  const Patches& patches = prepared.patched.patches;
  const FormFactors& f = prepared.factors;
  std::vector<double> sent(patches.size());
  for (size_t j = 0; j < sent.size(); ++j)
    sent[j] = double(
        luminance(patches.elements.reflectance[j] * (solution.direct[j] + solution.indirect[j])));
  double squares = 0, sum = 0, area = 0;
  for (size_t i = 0; i < patches.size(); ++i) {
    double mean = 0, square = 0;
    for (uint64_t k = f.first[i]; k < f.first[i + 1]; ++k) {
      const double b = sent[f.column[k]];
      mean += double(f.factor[k]) * b, square += double(f.factor[k]) * b * b;
    }
    const double a = double(patches.area_m2[i]);
    squares += a * std::max(0.0, square - mean * mean) / rays;
    sum += a * double(luminance(solution.direct[i] + solution.indirect[i])), area += a;
  }
  return sum > 0 ? std::sqrt(squares / area) * area / sum : 0;
}

}  // namespace

uint64_t bytes_of_preparation(size_t patches, int rays_per_patch) {
  // A ray meets at most one patch anew; the traced rows, their transpose and their mean, which has
  // up to twice as many entries, of a column and a factor each. A patch sees all others at most.
  const uint64_t entries =
      uint64_t(patches) * std::min<uint64_t>(patches, uint64_t(rays_per_patch));
  return entries * 4 * 8 + uint64_t(patches) * 4096;
}

Result<Prepared> prepare(const scene::Scene& scene, const trace::RayTracer& tracer,
                         const MatrixParams& params, Progress& progress, Team* team) {
  Prepared out;
  LUXEL_TRY(out.patched, make_patches(scene, tracer, params.patches, progress));
  LUXEL_TRY(TracedFactors traced,
            trace_factors(scene, tracer, out.patched, params.factors, progress, team));
  out.factors = reciprocal(traced.factors, out.patched.patches.area_m2);
  out.sky = std::move(traced.sky);
  out.rays = traced.rays;
  return out;
}

namespace {

/// E of the soft surroundings per patch. A background is what the patches' own rays saw of it; a
/// map is looked at again, by rays that know where they go.
Result<std::vector<Rgb>> sky_light(const scene::Scene& scene, const light::Lights& lights,
                                   const trace::RayTracer& tracer, const Prepared& prepared,
                                   const Probes& probes, uint64_t seed, Progress& progress) {
  const size_t n = prepared.patched.patches.size();
  std::vector<Rgb> sky(n);
  for (size_t i = 0; i < n; ++i) sky[i] = lights.around.background * (kPi * prepared.sky[i]);
  if (scene.environment.empty()) return sky;
  light::Lights map;
  map.around.limit = lights.around.limit;
  const light::DirectParams params{.samples = 1, .seed = seed, .sky_samples = kSkySamples};
  LUXEL_TRY(const light::DirectLight soft,
            light::direct_light(scene, probes.elements, map, tracer, params, progress));
  const std::vector<Rgb> mean = mean_at_patches(probes, soft.irradiance);
  for (size_t i = 0; i < n; ++i) sky[i] += mean[i];
  return sky;
}

}  // namespace

Result<Solution> solve(const scene::Scene& scene, const light::Lights& lights,
                       const trace::RayTracer& tracer, const Prepared& prepared,
                       const MatrixParams& params, Progress& progress) {
  const Patches& patches = prepared.patched.patches;
  const size_t n = patches.size();
  const Probes probes = probes_of(patches);
  const int samples = std::max(kLeastSamples, params.direct_samples / int(Patches::kProbes));
  LUXEL_TRY(const light::DirectLight direct,
            light::direct_light(scene, probes.elements, lights, tracer,
                                {samples, params.seed, false}, progress));
  Solution out;
  out.direct = mean_at_patches(probes, direct.irradiance), out.indirect.resize(n);
  LUXEL_TRY(const std::vector<Rgb> sky,
            sky_light(scene, lights, tracer, prepared, probes, params.seed, progress));
  std::vector<Rgb> change(n), sent(n);
  for (size_t i = 0; i < n; ++i) out.indirect[i] = sky[i], change[i] = out.direct[i] + sky[i];
  float largest = 0;
  for (const Rgb& rho : patches.elements.reflectance)
    largest = std::max(largest, max_component(rho));
  progress.begin("bounces", 0);
  double before = 0;
  const int sweeps = params.bounces < 0 ? kMaxSweeps : params.bounces;
  std::vector<Rgb> all = change;
  while (out.sweeps < sweeps) {
    LUXEL_TRY_STATUS(stopped(progress));
    for (size_t i = 0; i < n; ++i) sent[i] = patches.elements.reflectance[i] * change[i];
    multiply(prepared.factors, sent, change);
    for (size_t i = 0; i < n; ++i) out.indirect[i] += change[i], all[i] += change[i];
    ++out.sweeps;
    progress.advance(1);
    const double now = std::sqrt(mean_square(change, patches.area_m2));
    if (params.bounces < 0 &&
        light_to_come(now, before, double(largest)) <=
            double(params.tolerance) * std::sqrt(mean_square(all, patches.area_m2)))
      break;
    before = now;
  }
  out.rays = prepared.rays + direct.rays;
  out.relative_error = ray_error(prepared, out, params.factors.rays_per_patch);
  return out;
}

}  // namespace luxel::matrix
