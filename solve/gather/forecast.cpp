#include "solve/gather/forecast.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>

#include "base/parallel.h"
#include "base/random.h"
#include "solve/gather/adaptive.h"

namespace luxel::gather {
namespace {

constexpr int kSquare = 8;
constexpr size_t kFewestTexels = 1024;
/// Of uneven texels: points of each are as dear as a texel's whole direct light.
constexpr size_t kMostAveraged = 256;

template <class Work>
Result<double> seconds_of(const Work& work) {
  const auto start = std::chrono::steady_clock::now();
  LUXEL_TRY_STATUS(work());
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Texels of squares around every so-manieth texel, each once, in the order of the map.
std::vector<uint32_t> texels_to_try(const atlas::TexelMap& map, size_t count) {
  const size_t n = map.texels.size();
  const size_t squares = std::max<size_t>(1, count / size_t(kSquare * kSquare));
  std::vector<uint32_t> out;
  for (size_t k = 0; k < squares; ++k) {
    const size_t first = n * k / squares, end = n * (k + 1) / squares;
    const atlas::Texel& anchor = map.texels[first + hash64(0x7a1e, k) % (end - first)];
    for (int y = int(anchor.y); y < std::min(int(anchor.y) + kSquare, map.resolution); ++y)
      for (int x = int(anchor.x); x < std::min(int(anchor.x) + kSquare, map.resolution); ++x) {
        const uint32_t i = map.texel_at[size_t(y) * size_t(map.resolution) + size_t(x)];
        if (i != atlas::kNone) out.push_back(i);
      }
  }
  std::ranges::sort(out);
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

/// Those of `tried` whose neighbours were all tried too: of others it is not known whether light
/// varies around them.
std::vector<uint32_t> within(const atlas::TexelMap& map, std::span<const uint32_t> tried) {
  std::vector<uint8_t> is_tried(map.texels.size());
  for (const uint32_t i : tried) is_tried[i] = 1;
  const int side = map.resolution;
  std::vector<uint32_t> out;
  for (const uint32_t i : tried) {
    const int x0 = int(map.texels[i].x), y0 = int(map.texels[i].y);
    bool whole = true;
    for (int y = std::max(0, y0 - 1); y <= std::min(side - 1, y0 + 1); ++y)
      for (int x = std::max(0, x0 - 1); x <= std::min(side - 1, x0 + 1); ++x) {
        const uint32_t j = map.texel_at[size_t(y) * size_t(side) + size_t(x)];
        whole = whole && (j == atlas::kNone || is_tried[j]);
      }
    if (whole) out.push_back(i);
  }
  return out;
}

struct Trial {
  const transport::TexelScene& world;
  const GatherParams& params;
  std::vector<uint32_t> texels;
  double scale = 1;  ///< all texels over those tried
  transport::DirectLight direct;
  TracedHits hits;
};

Status try_direct(Trial& trial, Forecast& out, Progress& progress) {
  const auto& [scene, atlas, map, elements, lights, tracer] = trial.world;
  const transport::DirectParams params{trial.params.direct_samples, trial.params.seed};
  trial.direct.irradiance.resize(elements.size());
  trial.direct.variance.resize(elements.size());
  trial.direct.split_variance.resize(elements.size());
  LUXEL_TRY(const double seconds, seconds_of([&] {
              return direct_light_again(scene, elements, lights, tracer, trial.texels, params,
                                        trial.direct, progress);
            }));
  out.direct_s = trial.scale * seconds;
  out.rays += trial.scale * double(trial.direct.rays);
  return {};
}

Status try_supersample(Trial& trial, Forecast& out, Progress& progress) {
  const auto& [scene, atlas, map, elements, lights, tracer] = trial.world;
  if (trial.params.supersample <= 1) return {};
  const transport::SupersampleParams params{
      .points = trial.params.supersample,
      .direct = {trial.params.direct_samples, trial.params.seed}};
  const std::vector<uint32_t> known = within(map, trial.texels);
  const std::vector<uint32_t> uneven =
      transport::uneven_texels(atlas, map, trial.direct, params.threshold);
  std::vector<uint32_t> averaged;
  std::ranges::set_intersection(known, uneven, std::back_inserter(averaged));
  if (averaged.empty()) return {};
  const double all = double(averaged.size()) * double(elements.size()) / double(known.size());
  const size_t count = std::min(kMostAveraged, averaged.size());
  for (size_t k = 0; k < count; ++k) averaged[k] = averaged[averaged.size() * k / count];
  averaged.resize(count);
  const double scale = all / double(count);
  // They are too few for many threads, and a call looks at the whole map once: that is no texel's.
  const int threads = thread_count();
  const ThreadLimit one(1);
  uint64_t rays = 0;
  const auto seconds_for = [&](size_t texels) {
    return seconds_of([&]() -> Status {
      LUXEL_TRY(const transport::Supersampled done,
                average_texels(scene, atlas, map, elements, lights, tracer,
                               std::span(averaged).first(texels), params, trial.direct, progress));
      rays = done.rays;
      return {};
    });
  };
  LUXEL_TRY(const double fixed, seconds_for(0));
  LUXEL_TRY(const double with_fixed, seconds_for(count));
  const double seconds = std::max(0.0, with_fixed - fixed) / double(threads);
  out.supersample_s = scale * seconds, out.rays += scale * double(rays);
  return {};
}

Status try_tracing(Trial& trial, Forecast& out, Progress& progress) {
  const auto& [scene, atlas, map, elements, lights, tracer] = trial.world;
  trial.hits = no_hits(elements.size());
  std::vector<uint16_t> target(elements.size());
  for (const uint32_t i : trial.texels) target[i] = uint16_t(trial.params.samples);
  const TraceParams params{trial.params.seed, UINT64_MAX, trial.params.scratch_folder,
                           trial.params.bounces < 0 ? &lights : nullptr};
  LUXEL_TRY(const double seconds, seconds_of([&] {
              return trace_more(scene, atlas, elements, lights.around, tracer, target, params,
                                trial.hits, progress);
            }));
  out.trace_s = trial.scale * seconds;
  out.rays += trial.scale * double(trial.hits.rays);
  out.hit_bytes = trial.scale * double(trial.hits.bytes_in_memory());
  return {};
}

}  // namespace

Result<Forecast> forecast(const transport::TexelScene& world, const GatherParams& params, int part,
                          Progress& progress) {
  const size_t n = world.elements.size();
  const size_t most = size_t(kTrialRays / double(params.samples));
  const size_t count = std::min({n, most, std::max(kFewestTexels, n / size_t(part))});
  Trial trial{world, params, texels_to_try(world.map, std::max<size_t>(count, 1)), 1, {}, {}};
  trial.scale = double(n) / double(trial.texels.size());
  progress.begin("trial", 0);
  Progress own;  // its stages are not those of the bake
  Forecast out;
  LUXEL_TRY_STATUS(try_direct(trial, out, own));
  LUXEL_TRY_STATUS(try_supersample(trial, out, own));
  LUXEL_TRY_STATUS(try_tracing(trial, out, own));
  if (progress.cancelled()) return fail(ErrorCode::cancelled, "stopped by the user");
  const double sweeps = expected_sweeps(world.map, world.elements, trial.hits, params.samples,
                                        {params.bounces, params.tolerance});
  out.bounces_s = sweeps * (seconds_per_hit(world.map, trial.hits) * out.hit_bytes /
                            double(sizeof(StoredHit)) / double(thread_count()));
  return out;
}

}  // namespace luxel::gather
