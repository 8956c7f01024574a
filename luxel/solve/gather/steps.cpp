#include "luxel/solve/gather/steps.h"

#include <algorithm>
#include <utility>

#include "luxel/base/check.h"
#include "luxel/base/clock.h"
#include "luxel/base/free_memory.h"
#include "luxel/solve/gather/budget/adaptive.h"
#include "luxel/solve/gather/budget/repeat_check.h"
#include "luxel/solve/gather/rays/ray_device.h"
#include "luxel/solve/gather/reuse/earlier_direct.h"
#include "luxel/solve/gather/trace/trace_hits.h"

namespace luxel::gather {

void show(const GatherObserver& observer, const Progressive& light, bool is_last) {
  if (!observer.on_estimate) return;
  const double n = double(std::max<size_t>(light.hits.size(), 1));
  observer.on_estimate({.irradiance = light.bounced.irradiance,
                        .direct = light.direct.irradiance,
                        .samples = double(sum_of(light.hits.samples)) / n,
                        .error_p95 = light.errors.p95,
                        .is_last = is_last,
                        .error_rms = light.errors.expected.rms()});
}

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
  LUXEL_TRY(light.direct,
            light::direct_light(light::lit_elements(scene), supersample.direct, progress));
  if (has_left_parts(in)) return {};
  // Only light with noise is ever looked at more finely. Where it comes from one lamp, and few
  // elements see that one, all others' rays say nothing of how many it takes.
  const auto noisy = std::ranges::count_if(light.direct.variance, [](float v) { return v > 0; });
  light.shadow_rays_at_sample = noisy > 0 ? std::max(double(light.direct.rays) / double(noisy),
                                                     double(in.params.direct_samples))
                                          : 0;
  LUXEL_TRY(const light::Supersampled averaged,
            light::supersample(scene, supersample, light.direct, progress));
  light.direct.rays += averaged.rays;
  light.averaged = averaged.texels.size();
  if (light.averaged > 0)
    light.shadow_rays_at_points = double(averaged.rays) / double(light.averaged);
  // Rounds that may look finer, and bakes that are kept, need to know how finely light was sampled.
  if (!in.may_look_finer() && in.stores.keep == nullptr) return {};
  light.levels = {std::vector<uint8_t>(scene.elements.size()),
                  std::vector<uint8_t>(scene.elements.size())};
  for (const uint32_t i : averaged.texels) light.levels.averaged[i] = 1;
  return {};
}

namespace {

/// A round on the device.
Status trace_on_device(const Request& in, std::span<const uint16_t> target,
                       const TraceParams& trace, TracedHits& hits, Progress& progress) {
  LUXEL_CHECK(!trace.keep && !trace.earlier && !trace.layers);
  LUXEL_TRY_STATUS(
      in.stores.device->trace(trace_scene(in.scene, &in.sides), target, trace, hits, progress));
  LUXEL_TRY(HitStore none,
            HitStore::create(hits.size(), kTileElements, 0, 0, in.stores.scratch_folder));
  hits.rounds.push_back(std::move(none));
  hits.device = in.stores.device;
  return stopped(progress);
}

}  // namespace

Status trace_round(const Request& in, std::span<const uint16_t> target, Progressive& light,
                   Progress& progress, const TileWatch* watch) {
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
      .watch = watch,
      .team = in.stores.team,
  };
  const auto start = Clock::now();
  const uint64_t before = light.hits.rays, samples = sum_of(light.hits.samples);
  if (in.stores.device && in.scene.elements.size() > 0) {
    LUXEL_TRY_STATUS(trace_on_device(in, target, trace, light.hits, progress));
  } else {
    LUXEL_TRY_STATUS(
        trace_more(trace_scene(in.scene, &in.sides), target, trace, light.hits, progress));
  }
  if (light.hits.rounds.size() == 1)
    light.rays_per_ray = double(light.hits.rays + light.hits.rays_kept) /
                         double(std::max<uint64_t>(sum_of(light.hits.samples), 1));
  // Kept rays say nothing about how long the rays of later rounds take.
  const Progress::Snapshot stage = progress.snapshot();
  if (stage.total <= stage.skipped) return {};
  light.traced_s = seconds_since(start) * double(stage.total) / double(stage.total - stage.skipped);
  light.traced_rays = light.hits.rays - before;
  light.traced_samples = sum_of(light.hits.samples) - samples;
  return {};
}

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

Status choose_places(const Request& in, Progressive& light, Progress& progress) {
  const GatherParams& params = in.params;
  const uint64_t rays =
      check_rays(sum_of(light.hits.samples), params.max_error > 0, in.scene.elements.reflectance);
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

Status judge(const Request& in, Progressive& light, Progress& progress) {
  LUXEL_TRY(light.errors, light_errors(in.scene,
                                       {light.direct, light.bounced, light.hits, in.behind,
                                        light.check ? &*light.check : nullptr, in.params.bounces},
                                       progress));
  light.errors.expected.noise *= light.of_noise / kOfNoise;
  return {};
}

namespace {

/// Light to light anew. `noise`: what is believed of its luminance's variance.
LightToRepeat to_repeat(const Request& in, const Progressive& light, std::span<const float> noise) {
  return {light.direct, light.levels, light.hits, in.behind, light.bounced.irradiance, noise};
}
RepeatParams repeat_params(const Request& in, const Progressive& light) {
  return {in.supersample_params(), in.params.bounces < 0, spare_bytes(in.stores, light.hits),
          in.stores.scratch_folder};
}

/// Where the root mean square error is asked for, its noise is measured. Errors: cancelled, disk
/// full.
Status measure_noise(const Request& in, Progressive& light, Progress& progress) {
  if (in.params.max_error <= 0 || in.params.error_measure != ErrorMeasure::rms) return {};
  Progress own;  // its stages are not those of the bake
  LUXEL_TRY(
      const TrueNoise noise,
      noise_by_repeating(in.scene, in.sides, to_repeat(in, light, light.errors.noise_variance),
                         repeat_params(in, light), own));
  light.share_of_direct = noise.share_of_direct;
  light.errors.expected.noise *=
      noise.over_believed / std::exchange(light.of_noise, noise.over_believed);
  return stopped(progress);
}

}  // namespace

Result<light::Answers> answers_of(const Request& in, const Progressive& light,
                                  std::span<const uint8_t> enclosed, Progress& progress) {
  progress.begin("check", 0);
  std::vector<float> noise = light.direct.variance;
  for (size_t i = 0; i < noise.size(); ++i) noise[i] += light.bounced.variance[i];
  Progress own;  // its stages are those of the check
  LUXEL_TRY(light::Answers out,
            answers_by_repeating(in.scene, in.sides, to_repeat(in, light, noise), enclosed,
                                 repeat_params(in, light), own));
  LUXEL_TRY_STATUS(stopped(progress));
  return out;
}

Status estimate_round(const Request& in, Progressive& light, Progress& progress) {
  LUXEL_TRY_STATUS(bounce_round(in, kRoughTolerance, light, progress));
  const auto start = Clock::now();
  LUXEL_TRY_STATUS(judge(in, light, progress));
  LUXEL_TRY_STATUS(measure_noise(in, light, progress));
  light.judged_s = seconds_since(start);
  show(in.observer, light, false);
  return {};
}

}  // namespace luxel::gather
