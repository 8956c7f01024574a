#include "luxel/solve/gather/forecast/forecast_rounds.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "luxel/atlas/neighbours.h"
#include "luxel/base/clock.h"
#include "luxel/base/parallel.h"
#include "luxel/solve/gather/budget/adaptive.h"
#include "luxel/solve/gather/budget/error_p95.h"
#include "luxel/solve/gather/budget/expected_rms.h"
#include "luxel/solve/gather/budget/rms_round.h"
#include "luxel/solve/gather/forecast/expected_bounces.h"
#include "luxel/solve/gather/trace/trace_hits.h"

namespace luxel::gather {
namespace {

/// Rays, and shadow rays, of each texel that the trial's rays meet. Their noise, averaged over
/// neighbours, is small beside how light varies over what a texel sees.
constexpr int kCoarseSamples = 8;
constexpr int kForecastReach = 2;
/// Sweeps of the bounces after each round, which start from the solution of the one before.
constexpr double kSweepsOfRound = 2;

struct RoundsTrial {
  const light::TexelScene& in;
  const GatherParams& params;
  const GatherStores& stores;
  std::vector<uint32_t> texels;
  const transport::OwnSides& sides;
  double scale = 1;  ///< all texels over those tried
  std::vector<StoredHit> behind{};
  std::vector<Rgb> coarse{};  ///< E of all elements
  light::DirectLight direct{};
  light::DirectLevels levels{};
  TracedHits hits{};  ///< of others: as many samples as the coarse light has, which met nothing

  light::SupersampleParams supersample() const {
    return {.points = params.supersample, .direct = {params.direct_samples, params.seed}};
  }
  uint64_t rays() const { return direct.rays + hits.rays; }
};

/// Means over neighbours of the same chart, those inside of solids left out.
std::vector<Rgb> smooth(const light::TexelScene& in, const Gather& light) {
  const auto chart = [&](uint32_t i) { return in.atlas.chart[in.map.texels[i].triangle_number]; };
  const auto hidden = [&](uint32_t i) {
    return transport::is_hidden(
        transport::BackFaces{.rays = light.samples[i], .one_sided = light.met_back[i]});
  };
  std::vector<Rgb> out = light.irradiance;
  parallel_for(out.size(), 1024, [&](size_t begin, size_t end) {
    for (uint32_t i = uint32_t(begin); i < end; ++i) {
      Rgb sum{};
      float count = 0;
      for_neighbours(in.map, i, kForecastReach, [&](uint32_t j) {
        if (!hidden(j) && chart(j) == chart(i)) sum += light.irradiance[j], count += 1;
      });
      if (count > 0) out[i] = sum * (1 / count);
    }
  });
  return out;
}

/// The trial's texels and those around them, whose direct light says whether it varies there.
std::vector<uint32_t> with_neighbours(const atlas::TexelMap& map,
                                      std::span<const uint32_t> texels) {
  std::vector<uint8_t> is_near(map.texels.size());
  for (const uint32_t i : texels) for_neighbours(map, i, 1, [&](uint32_t j) { is_near[j] = 1; });
  std::vector<uint32_t> out;
  for (uint32_t i = 0; i < is_near.size(); ++i)
    if (is_near[i]) out.push_back(i);
  return out;
}

Status light_coarsely(RoundsTrial& trial, Progress& progress) {
  const GatherParams& all = trial.params;
  GatherParams params;
  params.samples = std::min(all.samples, kCoarseSamples);
  params.direct_samples = std::min(all.direct_samples, kCoarseSamples);
  params.bounces = all.bounces, params.tolerance = kRoughTolerance, params.seed = all.seed;
  const GatherStores stores{.hit_memory_bytes = trial.stores.hit_memory_bytes,
                            .scratch_folder = trial.stores.scratch_folder};
  LUXEL_TRY(Gather light, gather(trial.in, nullptr, params, stores, {}, progress));
  trial.coarse = smooth(trial.in, light);
  trial.direct.irradiance = std::move(light.direct);
  trial.direct.variance = light.direct_variance;
  trial.direct.split_variance = std::move(light.direct_variance);
  trial.hits = no_hits(trial.in.elements.size());
  trial.hits.counted = light.samples, trial.hits.samples = std::move(light.samples);
  trial.hits.met_back = std::move(light.met_back);
  for (const uint32_t i : trial.texels)
    trial.hits.samples[i] = trial.hits.counted[i] = trial.hits.met_back[i] = 0;
  return {};
}

Status light_directly(RoundsTrial& trial, Progress& progress) {
  const light::SupersampleParams params = trial.supersample();
  LUXEL_TRY_STATUS(direct_light_again(light::lit_elements(trial.in),
                                      with_neighbours(trial.in.map, trial.texels), params.direct,
                                      trial.direct, progress));
  LUXEL_TRY(const light::Supersampled averaged,
            light::supersample(trial.in, trial.texels, params, trial.direct, progress));
  const size_t n = trial.in.elements.size();
  trial.levels.level.resize(n), trial.levels.averaged.resize(n);
  for (const uint32_t i : averaged.texels) trial.levels.averaged[i] = 1;
  return {};
}

Status trace(RoundsTrial& trial, std::span<const uint16_t> target, Progress& progress) {
  const TraceParams trace{.seed = trial.params.seed,
                          .memory_limit_bytes = trial.stores.hit_memory_bytes,
                          .scratch_folder = trial.stores.scratch_folder,
                          .follows_near = trial.params.bounces < 0};
  return trace_more(trace_scene(trial.in, &trial.sides), target, trace, trial.hits, progress);
}

/// Relative, of the trial's texels; of all others 0.
struct ForecastErrors {
  std::vector<float> direct, gathered, all;
  std::vector<Rgb> irradiance;
  float p95 = 0;      ///< error_p95 of all that are tried
  double square = 0;  ///< of their mean light, times their number
};

/// As gather() knows them, but in the coarse light: one bounce of it.
Result<ForecastErrors> errors_of(const RoundsTrial& trial, Progress& progress) {
  // bounce() starts from what it is given and the soft sky: together the coarse light.
  std::vector<Rgb> given = trial.coarse;
  for (const uint32_t i : trial.texels)
    given[i] = given[i] - trial.hits.sky[i] * (kPi / float(trial.hits.samples[i]));
  LUXEL_TRY(const Bounced bounced,
            bounce(trial.in.map, trial.in.elements, trial.hits, given, trial.behind,
                   {.bounces = trial.params.bounces == 0 ? 0 : 1}, progress));
  std::vector<Rgb> irradiance = trial.coarse;
  for (const uint32_t i : trial.texels)
    irradiance[i] = trial.direct.irradiance[i] + (bounced.irradiance[i] - given[i]);
  const auto& atlas = trial.in.atlas;
  const auto& map = trial.in.map;
  const auto direct = pooled_variances(
      atlas, map, {trial.direct.variance, trial.direct.split_variance}, trial.texels);
  const auto gathered =
      pooled_variances(atlas, map, {bounced.variance, bounced.split_variance}, trial.texels);
  std::vector<float> all(direct.size());
  for (size_t i = 0; i < all.size(); ++i) all[i] = direct[i] + gathered[i];
  const auto relative = [&](std::span<const float> variance) {
    const std::vector<float> errors = relative_errors(variance, irradiance, trial.hits);
    std::vector<float> out(errors.size());
    for (const uint32_t i : trial.texels) out[i] = errors[i];
    return out;
  };
  ForecastErrors out;
  out.direct = relative(direct), out.gathered = relative(gathered), out.all = relative(all);
  std::vector<float> tried;
  double sum = 0;
  for (const uint32_t i : trial.texels)
    if (!is_hidden(trial.hits, i))
      tried.push_back(out.all[i]), sum += double(luminance(irradiance[i]));
  out.p95 = error_p95(tried);
  out.square = tried.empty() ? 0 : sum * sum / double(tried.size());
  out.irradiance = std::move(irradiance);
  return out;
}

/// Leaves what was traced for the trial.
void forget_coarse_light(RoundsTrial& trial) {
  std::vector<uint16_t> samples(trial.hits.size());
  for (const uint32_t i : trial.texels) samples[i] = trial.hits.samples[i];
  trial.hits.samples = std::move(samples);
}

/// The trial's rays.
double samples_of(const RoundsTrial& trial) {
  double sum = 0;
  for (const uint32_t i : trial.texels) sum += trial.hits.samples[i];
  return sum;
}

/// The next round for the texels that are tried. It adds nothing where their light is known.
RoundPlan next_round_of(const RoundsTrial& trial, const ForecastErrors& errors) {
  const GatherParams& params = trial.params;
  const std::vector<uint16_t>& samples = trial.hits.samples;
  const double max_error = double(params.max_error);
  if (params.error_measure == ErrorMeasure::rms) {
    const std::vector<float> gathered = variances_of(errors.gathered, errors.irradiance),
                             direct = variances_of(errors.direct, errors.irradiance);
    return plan_rms_round(
        {gathered, direct, samples, trial.levels}, max_error * max_error * errors.square / kOfNoise,
        INFINITY, ray_costs(1, params.direct_samples, params.supersample * 8), params.max_samples);
  }
  if (double(errors.p95) <= max_error) return {samples, std::vector<uint8_t>(samples.size())};
  const float each = error_of_part(params.max_error);
  return {next_samples(errors.gathered, each, params.max_samples, samples),
          elements_above(errors.direct, each)};
}

/// Makes all rounds. Returns the samples that every sweep looks at, from round to round. Errors:
/// cancelled, disk full.
Result<std::vector<double>> make_rounds(RoundsTrial& trial, RoundsForecast& out,
                                        Progress& progress) {
  std::vector<double> samples;
  for (;;) {
    samples.push_back(samples_of(trial));
    LUXEL_TRY(const ForecastErrors errors, errors_of(trial, progress));
    const RoundPlan round = next_round_of(trial, errors);
    const auto start = Clock::now();
    const uint64_t rays = trial.rays();
    LUXEL_TRY(const size_t finer, refine_direct(trial.in, round.finer, trial.supersample(),
                                                trial.levels, trial.direct, progress));
    const bool traces = round.samples != trial.hits.samples;
    if (finer == 0 && !traces) return samples;
    if (traces) LUXEL_TRY_STATUS(trace(trial, round.samples, progress));
    out.trace_s += trial.scale * seconds_since(start);
    out.rays += trial.scale * double(trial.rays() - rays);
  }
}

}  // namespace

Result<RoundsForecast> forecast_rounds(const light::TexelScene& in, const GatherParams& params,
                                       const GatherStores& stores, int part, Progress& progress) {
  const size_t n = in.elements.size();
  const size_t count = std::max<size_t>(1, std::min(n, std::max(kFewestTried, n / size_t(part))));
  const transport::OwnSides sides =
      transport::find_own_sides(in.scene, in.atlas, in.map, in.tracer);
  RoundsTrial trial{.in = in,
                    .params = params,
                    .stores = stores,
                    .texels = texels_to_try(in.map, count),
                    .sides = sides};
  trial.scale = double(n) / double(trial.texels.size());
  trial.behind = places_behind(sides, in.elements);
  LUXEL_TRY_STATUS(light_coarsely(trial, progress));
  LUXEL_TRY_STATUS(light_directly(trial, progress));
  std::vector<uint16_t> target = trial.hits.samples;
  for (const uint32_t i : trial.texels) target[i] = uint16_t(params.samples);
  LUXEL_TRY_STATUS(trace(trial, target, progress));
  const double before = double(trial.hits.bytes_in_memory() + trial.hits.bytes_in_file());
  RoundsForecast out;
  LUXEL_TRY(const std::vector<double> samples, make_rounds(trial, out, progress));
  const double bytes = double(trial.hits.bytes_in_memory() + trial.hits.bytes_in_file());
  out.hit_bytes = trial.scale * (bytes - before);
  forget_coarse_light(trial);
  // Bounces look at each round's hits, and in the end at those of all rounds.
  std::vector<uint32_t> all(n);
  std::iota(all.begin(), all.end(), 0u);
  LUXEL_TRY(const double fine,
            expected_sweeps(in.map, in.elements, {trial.hits, all, trial.direct.irradiance},
                            params.samples, {params.bounces, params.tolerance}));
  double looks = fine * samples.back();
  for (size_t k = 1; k < samples.size(); ++k) looks += kSweepsOfRound * samples[k];
  const double hits_per_sample = bytes / double(sizeof(StoredHit)) / samples.back();
  out.bounces_s = trial.scale * looks * hits_per_sample * seconds_per_hit(in.map, trial.hits) /
                  double(thread_count());
  return out;
}

}  // namespace luxel::gather
