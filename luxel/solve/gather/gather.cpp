#include "luxel/solve/gather/gather.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "luxel/base/clock.h"
#include "luxel/base/free_memory.h"
#include "luxel/solve/gather/bounce/bounce_layers.h"
#include "luxel/solve/gather/bounce/bounces.h"
#include "luxel/solve/gather/bounce/radiosity_map.h"
#include "luxel/solve/gather/budget/adaptive.h"
#include "luxel/solve/gather/budget/light_errors.h"
#include "luxel/solve/gather/reuse/earlier_direct.h"
#include "luxel/solve/gather/trace/trace_hits.h"
#include "luxel/transport/back_faces.h"

namespace luxel::gather {
namespace {

/// From an earlier bake's light they end at this part of its error: what is left does not show
/// beside that, nor above this.
constexpr double kPartOfError = 1.0 / 20, kRoughestFromEarlier = 3e-4;
/// What the last bounces take, over those of a round: from a tolerance of 1e-2 to one of 1e-4 is as
/// far as from 1 to 1e-2, and sweeps over all rays take more than sparse ones.
constexpr double kFineOverRough = 4;
/// A round that adds less than this part of the rays is not worth its bounces.
constexpr double kSmallestRound = 1.0 / 16;
/// The part of a round's rays that may be shadow rays.
constexpr double kDirectShare = 0.25;
/// What noise may have of an error when texels cost more than the rest of its square: half of it.
constexpr float kNoiseWithTexels = 0.70710678f;

constexpr uint8_t kPunctualLayer = 0, kOtherLayer = 1, kReflectedLayer = 2;

/// Layers that tell light straight from its sources apart. That which rays bring that are followed
/// on was reflected, whatever it is from.
struct SourceLayers {
  light::LightLayers straight, followed;
};
SourceLayers source_layers(const light::Lights& lights) {
  const auto all_in = [&](uint8_t punctual, uint8_t others) {
    light::LightLayers out;
    out.layers.resize(kSourceLayers);
    out.of_punctual.assign(lights.punctual.size(), punctual);
    out.of_triangle.assign(lights.triangles.size(), others);
    out.of_surroundings = others;
    return out;
  };
  return {all_in(kPunctualLayer, kOtherLayer), all_in(kReflectedLayer, kReflectedLayer)};
}

/// What gather() was asked for.
struct Request {
  const light::TexelScene& scene;
  const light::LightLayers* layers;
  const GatherParams& params;
  const GatherStores& stores;
  const GatherObserver& observer;
  const transport::OwnSides& sides;
  std::vector<StoredHit> behind{};                      ///< places_behind()
  const light::LightLayers* followed_layers = nullptr;  ///< of followed rays; null: `layers`

  size_t layer_count() const { return layers ? layers->size() : 0; }
  /// Whether rays are added where light is not known well enough.
  bool adds_rounds() const { return params.max_error > 0 || params.seconds > 0; }
  light::SupersampleParams supersample_params() const {
    return {.points = params.supersample,
            .direct = {.samples = params.direct_samples,
                       .seed = params.seed,
                       .parts = stores.parts,
                       .layers = layers}};
  }
};

/// The light so far, and the rays that it is made of.
struct Progressive {
  light::DirectLight direct;
  std::vector<Rgb> direct_before;  ///< direct light of an earlier bake
  light::DirectLevels levels;
  size_t averaged = 0;
  TracedHits hits;
  Bounced bounced;
  LightErrors errors;
  std::optional<ReadCheck> check;      ///< places at which what rays read is checked
  std::vector<Rgb> first_change;       ///< BounceParams
  double traced_s = 0, bounced_s = 0;  ///< of the last round in which something was traced
  uint64_t traced_rays = 0, traced_samples = 0;
};

void show(const GatherObserver& observer, const Progressive& light) {
  if (!observer.on_estimate) return;
  const double n = double(std::max<size_t>(light.hits.size(), 1));
  observer.on_estimate(
      {light.bounced.irradiance, double(sum_of(light.hits.samples)) / n, light.errors.p95});
}

/// Direct light, from scratch or from an earlier bake. Errors: cancelled.
Status begin_direct(const Request& in, Progressive& light, Progress& progress) {
  const light::TexelScene& scene = in.scene;
  const light::SupersampleParams supersample = in.supersample_params();
  Earlier* earlier = in.stores.earlier;
  if (earlier && !earlier->direct.irradiance.empty()) {
    if (earlier->rays.same_light) light.direct_before = earlier->direct.irradiance;
    LUXEL_TRY_STATUS(update_direct(scene, supersample, *earlier, progress));
    light.direct = std::move(earlier->direct);
    light.levels = std::move(earlier->levels);
    light.averaged = size_t(std::ranges::count(light.levels.averaged, 1));
    return {};
  }
  LUXEL_TRY(light.direct, light::direct_light(scene.scene, scene.elements, scene.lights,
                                              scene.tracer, supersample.direct, progress));
  LUXEL_TRY(const light::Supersampled averaged,
            light::supersample(scene, supersample, light.direct, progress));
  light.direct.rays += averaged.rays;
  light.averaged = averaged.texels.size();
  // Only rounds, and bakes that are kept, ask how finely light was sampled.
  if (!in.adds_rounds() && in.stores.keep == nullptr) return {};
  light.levels = {std::vector<uint8_t>(scene.elements.size()),
                  std::vector<uint8_t>(scene.elements.size())};
  for (const uint32_t i : averaged.texels) light.levels.averaged[i] = 1;
  return {};
}

Status trace_round(const Request& in, std::span<const uint16_t> target, Progressive& light,
                   Progress& progress) {
  const TraceParams trace{
      .seed = in.params.seed,
      .memory_limit_bytes = in.stores.hit_memory_bytes,
      .scratch_folder = in.stores.scratch_folder,
      .follows_near = in.params.bounces < 0,
      .parts = in.stores.parts,
      .keep = in.stores.keep,
      .earlier = in.stores.earlier ? &in.stores.earlier->rays : nullptr,
      .layers = in.layers,
      .followed_layers = in.followed_layers,
  };
  const auto start = Clock::now();
  const uint64_t before = light.hits.rays, samples = sum_of(light.hits.samples);
  LUXEL_TRY_STATUS(
      trace_more(trace_scene(in.scene, &in.sides), target, trace, light.hits, progress));
  // What was kept says nothing about how long rays take.
  const Progress::Snapshot stage = progress.snapshot();
  if (stage.total == stage.skipped) return {};
  light.traced_s = seconds_since(start) * double(stage.total) / double(stage.total - stage.skipped);
  light.traced_rays = light.hits.rays - before;
  light.traced_samples = sum_of(light.hits.samples) - samples;
  return {};
}

/// What hits leave of the memory that they may take.
uint64_t spare_bytes(const GatherStores& stores, const TracedHits& hits) {
  return stores.hit_memory_bytes - std::min(hits.bytes_in_memory(), stores.hit_memory_bytes);
}

Status bounce_round(const Request& in, float tolerance, Progressive& light, Progress& progress) {
  const auto start = Clock::now();
  const std::vector<Rgb> guess = std::move(light.bounced.irradiance);
  const BounceParams params{.bounces = in.params.bounces,
                            .tolerance = tolerance,
                            .start = guess,
                            .first_change = light.first_change,
                            .unknown = light.hits.unknown,
                            .spare_bytes = spare_bytes(in.stores, light.hits)};
  light.bounced = {}, light.errors = {};
  LUXEL_TRY(light.bounced, bounce(in.scene.map, in.scene.elements, light.hits,
                                  light.direct.irradiance, in.behind, params, progress));
  free_memory(light.first_change), free_memory(light.hits.unknown);
  light.bounced_s = seconds_since(start);
  return {};
}

/// The tolerance of the last bounces.
float last_tolerance(const Request& in) {
  if (!in.stores.earlier) return in.params.tolerance;
  const double of_error = kPartOfError * in.stores.earlier->relative_error;
  return std::max(in.params.tolerance, float(std::min(of_error, kRoughestFromEarlier)));
}

/// How far the light so far is off. Errors: cancelled.
Status judge(const Request& in, Progressive& light, Progress& progress) {
  LUXEL_TRY(light.errors, light_errors(in.scene,
                                       {light.direct, light.bounced, light.hits, in.behind,
                                        light.check ? &*light.check : nullptr, in.params.bounces},
                                       progress));
  return {};
}

/// The light of the rays so far, which are not all, and how well it is known.
Status estimate_round(const Request& in, Progressive& light, Progress& progress) {
  LUXEL_TRY_STATUS(bounce_round(in, kRoughTolerance, light, progress));
  LUXEL_TRY_STATUS(judge(in, light, progress));
  show(in.observer, light);
  return {};
}

/// How many rays the next round may have, such that it and the last bounces end in time: tracing
/// takes as long per ray as the last round, and bounces grow with the number of all rays.
double affordable_rays(const Progressive& light, double seconds_left) {
  const double rays = double(light.hits.rays), bounces_s = light.bounced_s * (1 + kFineOverRough);
  // Where all rays were found, some are traced to know what they take.
  if (light.traced_rays == 0) return kSmallestRound * rays;
  const double per_ray = light.traced_s / double(std::max<uint64_t>(light.traced_rays, 1));
  return (seconds_left - bounces_s) / (per_ray + bounces_s / rays);
}

/// Tells the watcher what is still to come, when an error is asked for.
void expect_rounds(const GatherParams& params, std::span<const uint16_t> target,
                   const Progressive& light, Progress& progress) {
  std::vector<uint64_t> rounds =
      rounds_to_come(light.errors.all, light.errors.gathered, params.max_error, params.max_samples,
                     light.hits.samples);
  const double before = double(sum_of(light.hits.samples));
  if (rounds.empty()) rounds.push_back(0);
  rounds.front() = sum_of(target) - uint64_t(before);  // that is known
  const double per_sample = light.traced_s / double(std::max<uint64_t>(light.traced_samples, 1));
  std::vector<Stage> stages;
  double samples = before;
  for (const uint64_t added : rounds) {
    samples += double(added);
    stages.push_back({"trace rays", double(added) * per_sample});
    stages.push_back({"bounces", light.bounced_s * samples / before});
  }
  stages.push_back({"bounces", kFineOverRough * light.bounced_s * samples / before});
  progress.expect(std::move(stages));
}

/// Adds rays where they are needed most. False: there is nothing to add, or no time.
Result<bool> next_round(const Request& in, double seconds_left, Progressive& light,
                        Progress& progress) {
  const GatherParams& params = in.params;
  if (light.errors.p95 <= params.max_error) return false;
  // The rest is what texels cost, and no ray helps.
  if (light.errors.noise_p95 <= kNoiseWithTexels * params.max_error) return false;
  // Indirect light gets more rays, direct light more shadow rays, where either is off by too much.
  const float each = error_of_part(params.max_error);
  const light::SupersampleParams supersample = in.supersample_params();
  std::vector<uint16_t> target =
      next_samples(light.errors.gathered, each, params.max_samples, light.hits.samples);
  float direct_above = each;
  // A time budget takes both back to what it can pay for, and ends the rounds.
  if (params.seconds > 0) {
    const double rays = affordable_rays(light, seconds_left);
    if (rays < kSmallestRound * double(light.hits.rays)) return false;
    const double rays_per_sample = double(light.hits.rays) / double(sum_of(light.hits.samples));
    keep_affordable(light.errors.gathered, uint64_t((1 - kDirectShare) * rays / rays_per_sample),
                    light.hits.samples, target);
    direct_above =
        affordable_error(light.errors.direct, each, kDirectShare * rays, supersample, light.levels);
  }
  if (params.seconds <= 0) expect_rounds(params, target, light, progress);
  LUXEL_TRY(const size_t finer, refine_direct(in.scene, light.errors.direct, direct_above,
                                              supersample, light.levels, light.direct, progress));
  if (target == light.hits.samples) return finer > 0;
  LUXEL_TRY_STATUS(trace_round(in, target, light, progress));
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
Status trace_earlier(const Request& in, Progressive& light, Progress& progress) {
  const light::TexelScene& scene = in.scene;
  EarlierRays& rays = in.stores.earlier->rays;
  // Rays tell what changes where light, reflectances and the number of samples are as they were.
  const bool tells =
      rays.same_light && !light.direct_before.empty() && in.params.bounces < 0 && !in.adds_rounds();
  if (!tells) free_memory(light.direct_before);
  RadiosityMap sent = empty_radiosity_map(tells ? scene.map.resolution : 0);
  if (tells) {
    fill_radiosity(sent, scene.map, scene.elements, light.hits, in.behind,
                   light.bounced.irradiance);
    rays.sent = &sent;
  }
  for (const std::vector<uint16_t>& target : in.stores.earlier->rounds)
    LUXEL_TRY_STATUS(trace_round(in, target, light, progress));
  rays.sent = nullptr;
  if (!tells) return {};
  // The change of a sweep: that of the mean over rays, and that of the direct light.
  light.first_change = std::move(light.hits.change);
  for (size_t i = 0; i < light.first_change.size(); ++i)
    light.first_change[i] = light.first_change[i] * (1 / float(light.hits.samples[i])) +
                            light.direct.irradiance[i] - light.direct_before[i];
  free_memory(light.direct_before);
  return {};
}

/// The rays that every element gets. Errors: cancelled, disk full.
Status trace_first(const Request& in, Progressive& light, Progress& progress) {
  const size_t n = in.scene.elements.size();
  const int all = in.params.samples;
  if (in.stores.earlier) return trace_earlier(in, light, progress);
  if (!in.observer.on_estimate)
    return trace_round(in, std::vector<uint16_t>(n, uint16_t(all)), light, progress);
  in.observer.on_estimate({with_ambient(in.scene.elements, light.direct.irradiance)});
  for (const int samples : growing(all)) {
    const std::vector<uint16_t> target(n, uint16_t(samples));
    LUXEL_TRY_STATUS(trace_round(in, target, light, progress));
    if (samples == all) break;  // what follows bounces them
    LUXEL_TRY_STATUS(estimate_round(in, light, progress));
  }
  return {};
}

/// What light was made of. The counts of rays stay.
void drop_light(TracedHits& hits) {
  free_memory(hits.sky), free_memory(hits.sky_by_layer);
  free_memory(hits.sky_luminance2), free_memory(hits.sky_first_less_second);
}

/// Places at which what rays read is checked, where that costs little beside the rays. Errors:
/// cancelled, disk full.
Status choose_places(const Request& in, Progressive& light, Progress& progress) {
  const GatherParams& params = in.params;
  const uint64_t rays = check_rays(sum_of(light.hits.samples), params.max_error > 0);
  if (params.bounces == 0 || rays == 0) return {};
  Progress own;  // its stages are not those of the bake
  LUXEL_TRY(light.check, make_read_check(in.scene, in.sides, light.hits,
                                         {.rays = rays,
                                          .follows_near = params.bounces < 0,
                                          .seed = params.seed,
                                          .scratch_folder = in.stores.scratch_folder},
                                         own));
  return stopped(progress);
}

/// The light of source_layers().
SourceLight source_light(Progressive& light) {
  const std::vector<Rgb> sources = layer_sources(light.hits, std::move(light.direct.by_layer));
  SourceLight out;
  for (size_t i = 0; i < sources.size(); i += kSourceLayers) {
    out.punctual.push_back(sources[i + kPunctualLayer]);
    out.others.push_back(sources[i + kOtherLayer]);
  }
  return out;
}

/// All bounces, those of layers too, and how well their light is known. Positions and normals of
/// elements may be gone.
Status bounce_last(const Request& in, Progressive& light, Gather& out, Progress& progress) {
  LUXEL_TRY_STATUS(bounce_round(in, last_tolerance(in), light, progress));
  if (in.params.tells_direct) {
    out.sources = source_light(light);
  } else if (in.layers) {
    LayeredLight layered{.source = layer_sources(light.hits, std::move(light.direct.by_layer)),
                         .whole = light.bounced.irradiance};
    LUXEL_TRY(
        LayersBounced layers,
        bounce_layers(in.scene.map, in.scene.elements, light.hits, in.behind, std::move(layered),
                      {in.params.bounces, spare_bytes(in.stores, light.hits)}, progress));
    out.layers = std::move(layers.irradiance), out.layers_shared_out = layers.shared_out;
  }
  out.hit_bytes_in_file = light.hits.bytes_in_file();
  light.hits.rounds.clear();
  LUXEL_TRY_STATUS(judge(in, light, progress));
  drop_light(light.hits);
  show(in.observer, light);
  return {};
}

/// Moves what the caller gets out of what is known in the end.
void take_result(Progressive&& light, Gather& out) {
  out.relative_error = light.errors.expected_rms;
  out.irradiance = std::move(light.bounced.irradiance);
  out.direct = std::move(light.direct.irradiance);
  out.direct_variance = std::move(light.direct.variance);
  out.indirect_variance = std::move(light.bounced.split_variance);
  out.pooled_variance = std::move(light.errors.noise_variance);
  out.error_p95 = light.errors.p95, out.noise_p95 = light.errors.noise_p95;
  out.errors = std::move(light.errors.all);
  out.gathered_errors = std::move(light.errors.gathered);
  out.met_back = std::move(light.hits.met_back);
  out.samples = std::move(light.hits.samples);
  out.rays = light.direct.rays + light.hits.rays, out.rays_kept = light.hits.rays_kept;
  out.supersampled = light.averaged;
  out.sweeps = light.bounced.sweeps;
}

}  // namespace

Result<Gather> gather(const light::TexelScene& scene, const light::LightLayers* layers,
                      const GatherParams& params, const GatherStores& stores,
                      const GatherObserver& observer, Progress& progress) {
  LUXEL_CHECK(!params.tells_direct || layers == nullptr);
  const auto start = Clock::now();
  const transport::OwnSides sides =
      transport::find_own_sides(scene.scene, scene.atlas, scene.map, scene.tracer);
  Request in{scene, layers, params, stores, observer, sides};
  const SourceLayers sources = params.tells_direct ? source_layers(scene.lights) : SourceLayers{};
  if (params.tells_direct) in.layers = &sources.straight, in.followed_layers = &sources.followed;
  Progressive light;
  // 1. Light straight from the lights, with shadow rays.
  LUXEL_TRY_STATUS(begin_direct(in, light, progress));
  // 2. The rays that every element gets, and what they hit.
  in.behind = places_behind(sides, scene.elements);
  light.hits = no_hits(scene.elements.size(), in.layer_count());
  if (stores.earlier) light.bounced.irradiance = std::move(stores.earlier->irradiance);
  LUXEL_TRY_STATUS(trace_first(in, light, progress));
  LUXEL_TRY_STATUS(choose_places(in, light, progress));
  // 3. Rounds of more rays where the estimated error is too large.
  for (bool more = in.adds_rounds(); more;) {
    LUXEL_TRY_STATUS(estimate_round(in, light, progress));
    LUXEL_TRY(more, next_round(in, params.seconds - seconds_since(start), light, progress));
  }
  // 4. Which elements lie inside of solids. After this nobody traces rays.
  Gather out;
  out.enclosed = transport::find_enclosed(scene.scene, scene.tracer, scene.elements,
                                          [&](size_t i) { return back_faces(light.hits, i); });
  free_memory(light.hits.escaped), free_memory(light.hits.met_double_sided_back);
  if (observer.on_traced) observer.on_traced();
  if (stores.keep) out.kept_direct = light.direct, out.kept_levels = light.levels;
  // 5. All bounces, by sweeps over the stored hits.
  LUXEL_TRY_STATUS(bounce_last(in, light, out, progress));
  take_result(std::move(light), out);
  return out;
}

}  // namespace luxel::gather
