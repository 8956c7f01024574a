#include "luxel/solve/gather/forecast/forecast.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <numeric>

#include "luxel/atlas/neighbours.h"
#include "luxel/base/clock.h"
#include "luxel/base/machine_load.h"
#include "luxel/base/parallel.h"
#include "luxel/solve/gather/budget/adaptive.h"
#include "luxel/solve/gather/forecast/expected_bounces.h"
#include "luxel/solve/gather/trace/trace_hits.h"

namespace luxel::gather {
namespace {

constexpr uint32_t kSquare = 5;

/// The time of all processors together. A trial is so short that other programs make its own time a
/// matter of chance.
template <class Task>
Result<double> processor_seconds_of(const Task& task) {
  const std::clock_t start = std::clock();
  LUXEL_TRY_STATUS(task());
  return processor_seconds_since(start);
}

}  // namespace

std::vector<uint32_t> texels_to_try(const atlas::TexelMap& map, size_t count) {
  const size_t n = map.texels.size();
  if (count >= n) {
    std::vector<uint32_t> all(n);
    std::iota(all.begin(), all.end(), 0u);
    return all;
  }
  const double part = double(count) / double(n);
  // Cells where a lattice of well spread points [Roberts18] is below `part`: they lie in all
  // regions of the map alike.
  const auto place = [](const atlas::Texel& texel) {
    const double p =
        0.7548776662466927 * (texel.x / kSquare) + 0.5698402909980532 * (texel.y / kSquare);
    return p - std::floor(p);
  };
  std::vector<uint32_t> out;
  for (uint32_t i = 0; i < n; ++i)
    if (place(map.texels[i]) < part) out.push_back(i);
  if (out.empty()) out.push_back(uint32_t(n / 2));
  return out;
}

namespace {

/// Those of `tried` whose neighbours were all tried too: of others it is not known whether light
/// varies around them.
std::vector<uint32_t> within(const atlas::TexelMap& map, std::span<const uint32_t> tried) {
  std::vector<uint8_t> is_tried(map.texels.size());
  for (const uint32_t i : tried) is_tried[i] = 1;
  std::vector<uint32_t> out;
  for (const uint32_t i : tried) {
    bool whole = true;
    for_neighbours(map, i, 1, [&](uint32_t j) { whole = whole && is_tried[j]; });
    if (whole) out.push_back(i);
  }
  return out;
}

/// Its times are those of one processor, until forecast() has them all.
struct Trial {
  const light::TexelScene& in;
  const GatherParams& params;
  const GatherStores& stores;
  std::vector<uint32_t> texels;
  double scale = 1;  ///< all texels over those tried
  light::DirectLight direct{};
  TracedHits hits{};
};

Status try_direct(Trial& trial, Forecast& out, Progress& progress) {
  const light::TexelScene& in = trial.in;
  const light::DirectParams params{trial.params.direct_samples, trial.params.seed};
  trial.direct.irradiance.resize(in.elements.size());
  trial.direct.variance.resize(in.elements.size());
  trial.direct.split_variance.resize(in.elements.size());
  LUXEL_TRY(const double seconds, processor_seconds_of([&] {
              return direct_light_again({in.scene, in.elements, in.lights, in.tracer}, trial.texels,
                                        params, trial.direct, progress);
            }));
  out.direct_s = trial.scale * seconds;
  out.rays += trial.scale * double(trial.direct.rays);
  return {};
}

Status try_supersample(Trial& trial, Forecast& out, Progress& progress) {
  const light::TexelScene& in = trial.in;
  if (trial.params.supersample <= 1) return {};
  const light::SupersampleParams params{.points = trial.params.supersample,
                                        .direct = {trial.params.direct_samples, trial.params.seed}};
  const std::vector<uint32_t> known = within(in.map, trial.texels);
  if (known.empty()) return {};
  const double scale = double(in.elements.size()) / double(known.size());
  // They are too few for many threads, and a call looks at the whole map once: that is no texel's.
  const ThreadLimit one(1);
  uint64_t rays = 0;
  const auto seconds_for = [&](std::span<const uint32_t> among) {
    return processor_seconds_of([&]() -> Status {
      LUXEL_TRY(const light::Supersampled done,
                light::supersample(in, among, params, trial.direct, progress));
      rays = done.rays;
      return {};
    });
  };
  LUXEL_TRY(const double fixed, seconds_for({}));
  LUXEL_TRY(const double with_fixed, seconds_for(known));
  out.supersample_s = fixed + scale * std::max(0.0, with_fixed - fixed);
  out.rays += scale * double(rays);
  return {};
}

/// The elements tried are traced as if there were no others: were they to lie in the midst of
/// others that get no rays, little of what rays share would be shared.
Status try_tracing(Trial& trial, Forecast& out, Progress& progress) {
  const light::TexelScene& in = trial.in;
  const transport::Elements tried = transport::subset(in.elements, trial.texels);
  const TraceParams params{.seed = trial.params.seed,
                           .scratch_folder = trial.stores.scratch_folder,
                           .follows_near = trial.params.bounces < 0};
  LUXEL_TRY(const double seconds, processor_seconds_of([&]() -> Status {
              LUXEL_TRY(trial.hits, trace_hits({in.scene, in.atlas, tried, in.lights, in.tracer},
                                               trial.params.samples, params, progress));
              return {};
            }));
  out.trace_s = trial.scale * seconds;
  out.rays += trial.scale * double(trial.hits.rays);
  out.hit_bytes = trial.scale * double(trial.hits.bytes_in_memory());
  return {};
}

Status try_bounces(Trial& trial, Forecast& out) {
  const light::TexelScene& in = trial.in;
  const GatherParams& params = trial.params;
  std::vector<Rgb> direct;
  for (const uint32_t i : trial.texels) direct.push_back(trial.direct.irradiance[i]);
  LUXEL_TRY(const double sweeps,
            expected_sweeps(in.map, in.elements, {trial.hits, trial.texels, direct}, params.samples,
                            {params.bounces, params.tolerance}));
  trial.direct = {};  // sweeps need a whole map of radiosity, which is as large
  const double hits = out.hit_bytes / double(sizeof(StoredHit));
  out.bounces_s = sweeps * hits * seconds_per_hit(in.map, trial.hits);
  return {};
}

}  // namespace

Result<Forecast> forecast(const light::TexelScene& in, const GatherParams& params,
                          const GatherStores& stores, TrialSize size, Progress& progress) {
  const size_t n = in.elements.size();
  const size_t most = size_t(kTrialRays / double(params.samples));
  const size_t count = std::min({n, most, std::max(size.fewest, n / size_t(size.part))});
  Trial trial{.in = in,
              .params = params,
              .stores = stores,
              .texels = texels_to_try(in.map, std::max<size_t>(count, 1))};
  trial.scale = double(n) / double(trial.texels.size());
  progress.begin("trial", 0);
  Progress own;  // its stages are not those of the bake
  Forecast out;
  LUXEL_TRY_STATUS(try_direct(trial, out, own));
  LUXEL_TRY_STATUS(try_supersample(trial, out, own));
  LUXEL_TRY_STATUS(try_tracing(trial, out, own));
  LUXEL_TRY_STATUS(stopped(progress));
  LUXEL_TRY_STATUS(try_bounces(trial, out));
  const double of_one = machine_load() / double(thread_count());
  for (double* seconds : {&out.direct_s, &out.supersample_s, &out.trace_s, &out.bounces_s})
    *seconds *= of_one;
  return out;
}

}  // namespace luxel::gather
