#include "luxel/solve/gather/gather.h"

#include <algorithm>
#include <cmath>

#include "luxel/base/clock.h"
#include "luxel/base/free_memory.h"
#include "luxel/solve/gather/bounce/bounce_layers.h"
#include "luxel/solve/gather/bounce/radiosity_map.h"
#include "luxel/solve/gather/reuse/earlier_direct.h"
#include "luxel/transport/backs_seen.h"

namespace luxel::gather {
namespace {

double relative_error(std::span<const Rgb> irradiance, std::span<const float> variance) {
  double mean = 0, sum = 0;
  for (size_t i = 0; i < irradiance.size(); ++i)
    mean += double(luminance(irradiance[i])), sum += double(variance[i]);
  return mean > 0 ? std::sqrt(sum * double(irradiance.size())) / mean : 0;
}

/// While samples are still to come the bounces need not be exact.
constexpr float kRoughTolerance = 1e-2f;
/// From an earlier bake's light they end at this part of its error: what is left does not show
/// beside that, nor above this.
constexpr double kPartOfError = 1.0 / 20, kRoughestFromEarlier = 3e-4;
/// What the last bounces take, over those of a round.
constexpr double kFineOverRough = 4;
/// A round that adds less than this part of the rays is not worth its bounces.
constexpr double kSmallestRound = 1.0 / 16;
/// Of a round's rays, those that may go to lamps.
constexpr double kDirectShare = 0.25;

/// Pooled variances, and relative errors by them.
struct Errors {
  std::vector<float> variance;
  std::vector<float> direct, gathered, all;  ///< relative
};

/// What there is so far.
struct Work {
  light::DirectLight direct;
  std::vector<Rgb> direct_before;  ///< of an earlier bake
  light::DirectLevels levels;
  size_t averaged = 0;
  TracedHits hits;
  Bounced bounced;
  Errors errors;
  std::vector<Rgb> first_change;       ///< BounceParams
  double traced_s = 0, bounced_s = 0;  ///< of the last round, of which something was traced
  uint64_t traced_rays = 0, traced_samples = 0;
};

Errors errors_of(const light::TexelScene& world, const Work& work) {
  auto direct =
      pooled_variances(world.atlas, world.map, {work.direct.variance, work.direct.split_variance});
  const auto gathered = pooled_variances(world.atlas, world.map,
                                         {work.bounced.variance, work.bounced.split_variance});
  Errors out;
  out.direct = relative_errors(direct, work.bounced.irradiance, work.hits);
  out.gathered = relative_errors(gathered, work.bounced.irradiance, work.hits);
  out.variance = std::move(direct);
  for (size_t i = 0; i < gathered.size(); ++i) out.variance[i] += gathered[i];
  out.all = relative_errors(out.variance, work.bounced.irradiance, work.hits);
  return out;
}

light::SupersampleParams supersample_params(const GatherParams& params) {
  return {.points = params.supersample,
          .direct = {.samples = params.direct_samples,
                     .seed = params.seed,
                     .parts = params.parts,
                     .layers = params.layers}};
}

void show(const GatherParams& params, const Work& work) {
  if (!params.on_estimate) return;
  const double n = double(std::max<size_t>(work.hits.size(), 1));
  params.on_estimate({work.bounced.irradiance, double(sum_of(work.hits.samples)) / n,
                      percentile_95(work.errors.all)});
}

/// Whether rays are added where light is not known well enough.
bool adds_rounds(const GatherParams& params) { return params.max_error > 0 || params.seconds > 0; }

Status begin_direct(const light::TexelScene& world, const GatherParams& params, Work& work,
                    Progress& progress) {
  const light::SupersampleParams supersample = supersample_params(params);
  if (params.earlier && !params.earlier->direct.irradiance.empty()) {
    if (params.earlier->rays.same_light) work.direct_before = params.earlier->direct.irradiance;
    LUXEL_TRY_STATUS(update_direct(world, supersample, *params.earlier, progress));
    work.direct = std::move(params.earlier->direct);
    work.levels = std::move(params.earlier->levels);
    work.averaged = size_t(std::ranges::count(work.levels.averaged, 1));
    return {};
  }
  LUXEL_TRY(work.direct, light::direct_light(world.scene, world.elements, world.lights,
                                             world.tracer, supersample.direct, progress));
  LUXEL_TRY(const light::Supersampled averaged,
            light::supersample(
                {world.scene, world.atlas, world.map, world.elements, world.lights, world.tracer},
                supersample, work.direct, progress));
  work.direct.rays += averaged.rays;
  work.averaged = averaged.texels.size();
  if (!adds_rounds(params) && params.keep == nullptr) return {};  // nobody asks how finely
  work.levels = {std::vector<uint8_t>(world.elements.size()),
                 std::vector<uint8_t>(world.elements.size())};
  for (const uint32_t i : averaged.texels) work.levels.averaged[i] = 1;
  return {};
}

Status trace_round(const light::TexelScene& world, const GatherParams& params,
                   std::span<const uint16_t> target, Work& work, Progress& progress) {
  const TraceParams trace{.seed = params.seed,
                          .memory_limit_bytes = params.hit_memory_bytes,
                          .scratch_folder = params.scratch_folder,
                          .near_lights = params.bounces < 0 ? &world.lights : nullptr,
                          .parts = params.parts,
                          .keep = params.keep,
                          .earlier = params.earlier ? &params.earlier->rays : nullptr,
                          .layers = params.layers};
  const auto start = Clock::now();
  const uint64_t before = work.hits.rays, samples = sum_of(work.hits.samples);
  LUXEL_TRY_STATUS(trace_more(world.scene, world.atlas, world.elements, world.lights.around,
                              world.tracer, target, trace, work.hits, progress));
  // What was kept says nothing about how long rays take.
  const Progress::Snapshot stage = progress.snapshot();
  if (stage.total == stage.skipped) return {};
  work.traced_s = seconds_since(start) * double(stage.total) / double(stage.total - stage.skipped);
  work.traced_rays = work.hits.rays - before;
  work.traced_samples = sum_of(work.hits.samples) - samples;
  return {};
}

/// What hits leave of the memory that they may take.
uint64_t spare_bytes(const GatherParams& params, const TracedHits& hits) {
  return params.hit_memory_bytes - std::min(hits.bytes_in_memory(), params.hit_memory_bytes);
}

Status bounce_round(const light::TexelScene& world, const GatherParams& all,
                    std::span<const StoredHit> behind, float tolerance, Work& work,
                    Progress& progress) {
  const auto start = Clock::now();
  const std::vector<Rgb> guess = std::move(work.bounced.irradiance);
  const BounceParams params{.bounces = all.bounces,
                            .tolerance = tolerance,
                            .start = guess,
                            .first_change = work.first_change,
                            .unknown = work.hits.unknown,
                            .spare_bytes = spare_bytes(all, work.hits)};
  work.bounced = {}, work.errors = {};
  LUXEL_TRY(work.bounced, bounce(world.map, world.elements, work.hits, work.direct.irradiance,
                                 behind, params, progress));
  free_memory(work.first_change), free_memory(work.hits.unknown);
  work.bounced_s = seconds_since(start);
  return {};
}

/// Of the last bounces.
float last_tolerance(const GatherParams& params) {
  if (!params.earlier) return params.tolerance;
  const double of_error = kPartOfError * params.earlier->relative_error;
  return std::max(params.tolerance, float(std::min(of_error, kRoughestFromEarlier)));
}

/// The light of the rays so far, which are not all, and how well it is known.
Status look_round(const light::TexelScene& world, const GatherParams& params,
                  std::span<const StoredHit> behind, Work& work, Progress& progress) {
  LUXEL_TRY_STATUS(bounce_round(world, params, behind, kRoughTolerance, work, progress));
  work.errors = errors_of(world, work);
  show(params, work);
  return {};
}

/// How many rays the next round may have, such that it and the last bounces end in time.
double affordable_rays(const Work& work, double seconds_left) {
  const double rays = double(work.hits.rays), bounces_s = work.bounced_s * (1 + kFineOverRough);
  if (work.traced_rays == 0) return kSmallestRound * rays;  // all found: some are traced to know
  const double per_ray = work.traced_s / double(std::max<uint64_t>(work.traced_rays, 1));
  return (seconds_left - bounces_s) / (per_ray + bounces_s / rays);
}

/// Tells the watcher what is still to come, when an error is asked for.
void expect_rounds(const GatherParams& params, std::span<const uint16_t> target, const Work& work,
                   Progress& progress) {
  std::vector<uint64_t> rounds =
      rounds_to_come(work.errors.all, work.errors.gathered, params.max_error, params.max_samples,
                     work.hits.samples);
  const double before = double(sum_of(work.hits.samples));
  if (rounds.empty()) rounds.push_back(0);
  rounds.front() = sum_of(target) - uint64_t(before);  // that is known
  const double per_sample = work.traced_s / double(std::max<uint64_t>(work.traced_samples, 1));
  std::vector<Stage> stages;
  double samples = before;
  for (const uint64_t added : rounds) {
    samples += double(added);
    stages.push_back({"trace rays", double(added) * per_sample});
    stages.push_back({"bounces", work.bounced_s * samples / before});
  }
  stages.push_back({"bounces", kFineOverRough * work.bounced_s * samples / before});
  progress.expect(std::move(stages));
}

/// Adds rays where they are needed most. False: there is nothing to add, or no time.
Result<bool> next_round(const light::TexelScene& world, const GatherParams& params,
                        double seconds_left, Work& work, Progress& progress) {
  if (percentile_95(work.errors.all) <= params.max_error) return false;
  const float each = error_of_part(params.max_error);
  const light::SupersampleParams supersample = supersample_params(params);
  std::vector<uint16_t> target =
      next_samples(work.errors.gathered, each, params.max_samples, work.hits.samples);
  float direct_above = each;
  if (params.seconds > 0) {
    const double rays = affordable_rays(work, seconds_left);
    if (rays < kSmallestRound * double(work.hits.rays)) return false;
    const double rays_per_sample = double(work.hits.rays) / double(sum_of(work.hits.samples));
    keep_affordable(work.errors.gathered, uint64_t((1 - kDirectShare) * rays / rays_per_sample),
                    work.hits.samples, target);
    direct_above =
        affordable_error(work.errors.direct, each, kDirectShare * rays, supersample, work.levels);
  }
  if (params.seconds <= 0) expect_rounds(params, target, work, progress);
  LUXEL_TRY(const size_t finer, refine_direct(world, work.errors.direct, direct_above, supersample,
                                              work.levels, work.direct, progress));
  if (target == work.hits.samples) return finer > 0;
  LUXEL_TRY_STATUS(trace_round(world, params, target, work, progress));
  return true;
}

/// Light that surfaces send each other, if it is spread evenly: of what they reflect of the direct
/// light, the part rho that the next reflection leaves, and so on [Cohen88, section 5]. Exact where
/// direct light and reflectance are the same everywhere and nothing is open.
std::vector<Rgb> with_ambient(const transport::Elements& elements, std::span<const Rgb> direct) {
  Rgb sent{}, rho{};
  for (size_t i = 0; i < direct.size(); ++i)
    sent += elements.reflectance[i] * direct[i], rho += elements.reflectance[i];
  const float part = 1 / float(std::max<size_t>(direct.size(), 1));
  const Rgb left = Rgb{1, 1, 1} - rho * part;
  const Rgb ambient = sent * part * Rgb{1 / left.x, 1 / left.y, 1 / left.z};
  std::vector<Rgb> out(direct.begin(), direct.end());
  for (Rgb& e : out) e += ambient;
  return out;
}

/// The samples after each round, for one who watches: doubled from a few up to all.
std::vector<int> growing(int samples) {
  constexpr int kFewest = 8;
  std::vector<int> out{samples};
  while (out.back() >= 2 * kFewest) out.push_back(out.back() / 2);
  std::ranges::reverse(out);
  return out;
}

/// The rays of an earlier bake. Where only what lies elsewhere changes them, they tell by how much
/// the light of then changes in a sweep, too. Errors: cancelled, disk full.
Status trace_earlier(const light::TexelScene& world, const GatherParams& params,
                     std::span<const StoredHit> behind, Work& work, Progress& progress) {
  EarlierRays& rays = params.earlier->rays;
  const bool tells =
      rays.same_light && !work.direct_before.empty() && params.bounces < 0 && !adds_rounds(params);
  if (!tells) free_memory(work.direct_before);
  RadiosityMap sent = empty_radiosity_map(tells ? world.map.resolution : 0);
  if (tells) {
    fill_radiosity(sent, world.map, world.elements, work.hits, behind, work.bounced.irradiance);
    rays.sent = &sent;
  }
  for (const std::vector<uint16_t>& target : params.earlier->rounds)
    LUXEL_TRY_STATUS(trace_round(world, params, target, work, progress));
  rays.sent = nullptr;
  if (!tells) return {};
  work.first_change = std::move(work.hits.change);
  for (size_t i = 0; i < work.first_change.size(); ++i)
    work.first_change[i] = work.first_change[i] * (1 / float(work.hits.samples[i])) +
                           work.direct.irradiance[i] - work.direct_before[i];
  free_memory(work.direct_before);
  return {};
}

/// The rays that every element gets. Errors: cancelled, disk full.
Status trace_first(const light::TexelScene& world, const GatherParams& params,
                   std::span<const StoredHit> behind, Work& work, Progress& progress) {
  const size_t n = world.elements.size();
  if (params.earlier) return trace_earlier(world, params, behind, work, progress);
  if (!params.on_estimate)
    return trace_round(world, params, std::vector<uint16_t>(n, uint16_t(params.samples)), work,
                       progress);
  params.on_estimate({with_ambient(world.elements, work.direct.irradiance)});
  for (const int samples : growing(params.samples)) {
    const std::vector<uint16_t> target(n, uint16_t(samples));
    LUXEL_TRY_STATUS(trace_round(world, params, target, work, progress));
    if (samples == params.samples) break;  // what follows bounces them
    LUXEL_TRY_STATUS(look_round(world, params, behind, work, progress));
  }
  return {};
}

/// What bounces have read. The counts of rays stay.
void drop_light(TracedHits& hits) {
  hits.rounds.clear();
  free_memory(hits.sky), free_memory(hits.sky_by_layer);
  free_memory(hits.sky_luminance2), free_memory(hits.sky_first_less_second);
}

/// All bounces, those of layers too, and how well their light is known. Places of elements may be
/// gone.
Status bounce_last(const light::TexelScene& world, const GatherParams& params,
                   std::span<const StoredHit> behind, Work& work, Gather& out, Progress& progress) {
  LUXEL_TRY_STATUS(bounce_round(world, params, behind, last_tolerance(params), work, progress));
  if (params.layers) {
    LUXEL_TRY(LayersBounced layers,
              bounce_layers(world.map, world.elements, work.hits,
                            layer_sources(work.hits, std::move(work.direct.by_layer)), behind,
                            work.bounced.irradiance,
                            {params.bounces, spare_bytes(params, work.hits)}, progress));
    out.layers = std::move(layers.irradiance), out.layers_shared_out = layers.shared_out;
  }
  out.hit_bytes_in_file = work.hits.bytes_in_file();
  drop_light(work.hits);
  work.errors = errors_of(world, work);
  show(params, work);
  return {};
}

}  // namespace

Result<Gather> gather(const scene::Scene& scene, const atlas::Atlas& atlas,
                      const atlas::TexelMap& map, const transport::Elements& elements,
                      const light::Lights& lights, const trace::RayTracer& tracer,
                      const GatherParams& params, Progress& progress) {
  const auto start = Clock::now();
  const light::TexelScene world{scene, atlas, map, elements, lights, tracer};
  Work work;
  LUXEL_TRY_STATUS(begin_direct(world, params, work, progress));
  const std::vector<StoredHit> behind = places_behind(scene, atlas, map, elements);
  work.hits = no_hits(elements.size(), params.layers ? params.layers->size() : 0);
  if (params.earlier) work.bounced.irradiance = std::move(params.earlier->irradiance);
  LUXEL_TRY_STATUS(trace_first(world, params, behind, work, progress));
  for (bool more = adds_rounds(params); more;) {
    LUXEL_TRY_STATUS(look_round(world, params, behind, work, progress));
    LUXEL_TRY(more,
              next_round(world, params, params.seconds - seconds_since(start), work, progress));
  }
  Gather out;
  out.enclosed = transport::find_enclosed(scene, tracer, elements, [&](size_t i) {
    return transport::BacksSeen{int(work.hits.samples[i]), int(work.hits.met_back[i]),
                                int(work.hits.met_double_sided_back[i])};
  });
  free_memory(work.hits.escaped), free_memory(work.hits.met_double_sided_back);
  if (params.on_traced) params.on_traced();
  if (params.keep) out.kept_direct = work.direct, out.kept_levels = work.levels;
  LUXEL_TRY_STATUS(bounce_last(world, params, behind, work, out, progress));
  out.relative_error = relative_error(work.bounced.irradiance, work.errors.variance);
  out.irradiance = std::move(work.bounced.irradiance);
  out.direct = std::move(work.direct.irradiance);
  out.direct_variance = std::move(work.direct.variance);
  out.indirect_variance = std::move(work.bounced.split_variance);
  out.pooled_variance = std::move(work.errors.variance);
  out.relative_error_p95 = percentile_95(work.errors.all);
  out.errors = std::move(work.errors.all);
  out.gathered_errors = std::move(work.errors.gathered);
  out.met_back = std::move(work.hits.met_back);
  out.samples = std::move(work.hits.samples);
  out.rays = work.direct.rays + work.hits.rays, out.rays_kept = work.hits.rays_kept;
  out.supersampled = work.averaged;
  out.sweeps = work.bounced.sweeps;
  return out;
}

}  // namespace luxel::gather
