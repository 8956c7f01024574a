// Radiosity maps by Monte Carlo rays as a solver of lightmaps: to a number of samples, to an error,
// or to a time, from scratch or on an earlier bake.
#include "luxel/pipeline/solver/gather.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "luxel/base/clock.h"
#include "luxel/base/free_memory.h"
#include "luxel/base/output_folder.h"
#include "luxel/base/share_out.h"
#include "luxel/pipeline/reuse/bake_cache.h"
#include "luxel/pipeline/reuse/rebake.h"
#include "luxel/pipeline/settings/quality.h"
#include "luxel/pipeline/solver/gather_memory.h"
#include "luxel/pipeline/solver/gather_plan.h"
#include "luxel/pipeline/solver/light_part.h"
#include "luxel/pipeline/solver/memory.h"
#include "luxel/pipeline/solver/on_device.h"
#include "luxel/pipeline/solver/solver.h"
#include "luxel/pipeline/solver/stage_seconds.h"
#include "luxel/pipeline/solver/texel_light.h"
#include "luxel/solve/gather/forecast/forecast.h"
#include "luxel/solve/gather/gather.h"
#include "luxel/solve/gather/rays/ray_device.h"

namespace luxel::pipeline {
namespace {

/// Samples of the first round, when an error is asked for.
constexpr int kFirstSamples = 32;
/// A trial lights one texel in so many, which costs as much of the bake; of small maps one in so
/// many at most.
constexpr int kTrialPart = 100, kMostTrialPart = 25;
/// Bakes below so many rays are over before anybody looks at the clock: no trial is worth it.
constexpr double kRaysWorthATrial = 2e6;
/// Stages after light may take so many times what is expected, and still end in time.
constexpr double kSafeAfter = 1.25;
/// The most of a time budget that the first direct light and the first rays may take.
constexpr double kFirstShare = 0.3;

void warn_about_rounds(const BakeSettings& settings, const gather::GatherParams& params,
                       const gather::Gather& result, std::vector<std::string>& warnings) {
  const std::string winner = settings.max_error > 0
                                 ? fmt::format("--max-error {}", settings.max_error)
                                 : fmt::format("--time-budget {}", settings.time_budget_s);
  if (settings.samples_given)
    warnings.push_back(fmt::format("{} sets the number of rays; --samples {} is ignored", winner,
                                   settings.samples));
  const bool is_rms = settings.error_measure == gather::ErrorMeasure::rms;
  const double error = is_rms ? result.relative_error : double(result.error_p95);
  const double noise = is_rms ? result.relative_noise : double(result.noise_p95);
  if (settings.max_error <= 0 || error <= settings.max_error) return;
  const std::string why =
      noise <= settings.max_error
          ? "because texels are too large to show how light varies; give a higher --resolution"
      : settings.time_budget_s > 0
          ? fmt::format("when --time-budget {} ran out", settings.time_budget_s)
          : fmt::format("at the limit of {} rays per texel", params.max_samples);
  warnings.push_back(fmt::format(
      "--max-error {} was not reached: {} {:.2g}, {}", settings.max_error,
      is_rms ? "the root mean square error is" : "95 % of texels err by less than", error, why));
}

/// The forecast of a team, where one process needs `f`. All members use the first one's.
Result<gather::Forecast> shared_out(Team* team, gather::Forecast f, Progress& progress) {
  if (!team) return f;
  for (double* seconds : {&f.direct_s, &f.supersample_s, &f.trace_s, &f.bounces_s}) {
    LUXEL_TRY(*seconds, first_of(team, *seconds / double(team->size()), progress));
  }
  return f;
}

/// Makes the first round small enough for `seconds`. The forecast is that of `params`.
void shrink_first_round(const gather::Forecast& forecast, double seconds,
                        gather::GatherParams& params) {
  const double share = kFirstShare * std::max(seconds, 0.0);
  double points_s = forecast.supersample_s;
  if (forecast.direct_s + points_s > share) {
    const double part = share / (forecast.direct_s + points_s);
    params.direct_samples = std::max(1, int(params.direct_samples * part));
    // Points have a few shadow rays each, however few there are of the texel.
    if (points_s > share) params.supersample = std::max(1, int(params.supersample * part));
  }
  if (forecast.trace_s > share)
    params.samples = std::max(1, int(params.samples * share / forecast.trace_s));
}

/// Tells how long it will take, where a trial can know it and is worth it, and fits the first round
/// into a time budget. With max_error it is told by gather, after the first round.
Status look_ahead(const light::TexelScene& in, const BakeSettings& settings,
                  const SolveStores& stores, const gather::GatherStores& own,
                  gather::GatherParams& params, std::vector<std::string>& warnings,
                  Progress& progress) {
  const BakeSize size = bake_size(in, settings);
  const std::vector<Stage> after = stages_after_solving(size, settings);
  progress.expect_at_end(after);
  const double rays = double(in.elements.size()) * (params.samples + params.direct_samples);
  // A trial is the processor's, and says nothing of a device.
  const bool trial = rays >= kRaysWorthATrial && settings.max_error <= 0 && !stores.device &&
                     settings.part.is_all();
  if (!trial && settings.time_budget_s <= 0) return {};
  // Each member makes its own trial, of the whole team's part.
  const int part = kTrialPart * (stores.team ? int(stores.team->size()) : 1);
  const size_t fewest = std::min(gather::kFewestTried, in.elements.size() / kMostTrialPart);
  LUXEL_TRY(gather::Forecast forecast, gather::forecast(in, params, own, {part, fewest}, progress));
  LUXEL_TRY(forecast, shared_out(stores.team, forecast, progress));
  progress.finish();
  if (settings.time_budget_s <= 0) {
    progress.expect(stages_of(forecast, settings, size));
    return {};
  }
  double left =
      seconds_left(settings.time_budget_s, progress.stages()) - kSafeAfter * seconds_of(after);
  LUXEL_TRY(left, first_of(stores.team, left, progress));
  if (left < forecast.seconds() / params.samples)
    warnings.push_back(
        fmt::format("--time-budget {} leaves {:.1f} s for the light, besides reading, layout, "
                    "drawing and writing; that is too little, and the bake takes longer",
                    settings.time_budget_s, std::max(left, 0.0)));
  shrink_first_round(forecast, left, params);
  params.seconds = std::max(left, 1e-3);
  progress.expect_within(params.seconds);
  return {};
}

}  // namespace

gather::GatherParams gather_params(const BakeSettings& settings) {
  gather::GatherParams params;
  const bool rounds = adds_rounds(settings);
  params.samples = rounds ? kFirstSamples : settings.samples;
  params.max_error = float(settings.max_error);
  params.error_measure = settings.error_measure;
  params.direct_samples = first_direct_samples(settings);
  params.supersample = first_supersample(settings);
  params.more_shadow_rays = !rounds && !settings.direct_samples;
  params.more_points = !rounds && !settings.supersample;
  params.bounces = settings.bounces;
  params.tells_direct = settings.light != LightPart::all;
  params.tells_answers = settings.denoise && settings.light == LightPart::all && params.bounces < 0;
  // A given number of rays is kept to.
  params.more_rays = params.tells_answers && settings.quality == Quality::good &&
                     settings.samples == numbers_of(Quality::good).samples;
  params.seed = settings.seed;
  return params;
}

gather::GatherStores gather_stores(const BakeSettings& settings) {
  return {.scratch_folder = nearest_folder(settings.output)};
}

namespace {

/// Light from gather's result; without warnings.
TexelLight light_of(gather::Gather& result, light::LightLayers& layers) {
  TexelLight out = texel_light(std::move(result));
  out.errors = std::move(result.errors), out.error_p95 = result.error_p95;
  out.samples = std::move(result.samples);
  out.layers = std::move(layers.layers), out.layer_irradiance = std::move(result.layers);
  out.direct = std::move(result.direct);
  out.direct_variance = std::move(result.direct_variance);
  out.variance = std::move(result.indirect_variance);
  out.relative_unseen = result.relative_unseen, out.answers = std::move(result.answers);
  out.sweeps = result.sweeps, out.supersampled_texels = result.supersampled;
  out.scratch_bytes = result.hit_bytes_in_file, out.rays_kept = result.rays_kept;
  return out;
}

/// The layers that light is told apart into; none where nobody asks, or, for a bake that is kept,
/// where there are too many. Errors: too many.
Result<light::LightLayers> layers_of(const light::TexelScene& in, const BakeSettings& settings,
                                     bool keeps) {
  if (settings.layers != light::LayerMode::none)
    return light::light_layers(in.scene, in.lights, settings.layers);
  if (!keeps) return light::LightLayers{};
  return light::light_layers(in.scene, in.lights, light::LayerMode::per_light)
      .value_or(light::LightLayers{});
}

/// The bake's light with what later bakes can build on.
KeptBake kept_bake(const light::TexelScene& in, const light::LightLayers& layers,
                   gather::Gather& result, const TexelLight& light) {
  KeptBake kept;
  kept.places = places_of(in.elements);
  for (const light::LightLayer& layer : light.layers) kept.layer_names.push_back(layer.name);
  if (!kept.layer_names.empty()) kept.layers = layers_of_lights(in.scene, in.lights, layers);
  kept.direct = std::move(result.kept_direct), kept.levels = std::move(result.kept_levels);
  kept.light = light;
  return kept;
}

/// Drops layers that nobody has asked for.
void drop_layers(TexelLight& light) { light.layers.clear(), free_memory(light.layer_irradiance); }

/// The arguments of gather().
struct GatherCall {
  const light::TexelScene& in;
  const light::LightLayers* layers;
  gather::GatherParams params;
  gather::GatherStores stores;
  gather::GatherObserver observer;
};
Result<gather::Gather> run(const GatherCall& call, Progress& progress) {
  return gather::gather(call.in, call.layers, call.params, call.stores, call.observer, progress);
}

/// gather() on a device. Errors: those of gather().
Result<gather::Gather> run_on(const BakeDevice& on, GatherCall call, Progress& progress) {
  call.stores.device = on.rays;
  // Where the device fails, the processor looks at all places again.
  const std::function<void()> on_traced = std::move(call.observer.on_traced);
  call.observer.on_traced = on.is_optional ? std::function<void()>() : on_traced;
  auto out = run(call, progress);
  if (out && on.is_optional && on_traced) on_traced();
  return out;
}

/// gather() on the device, if there is one; where that is optional and fails, all of it on the
/// processor in the time that is left. `part` gets what had the rays. Errors: those of gather().
Result<gather::Gather> gather_on_any(const BakeDevice* on, GatherCall call, TookPart& part,
                                     Progress& progress) {
  const auto start = Clock::now();
  const double seconds = call.params.seconds;
  const auto gather_on = [&](const BakeDevice* device) {
    if (seconds > 0) call.params.seconds = std::max(seconds - seconds_since(start), 1e-3);
    return device ? run_on(*device, call, progress) : run(call, progress);
  };
  return run_on_any(on, gather_on, part);
}

Result<TexelLight> solve_gather(const light::TexelScene& in, const BakeSettings& settings,
                                const SolveStores& stores, const SolveObserver& observer,
                                Progress& progress) {
  gather::GatherParams params = gather_params(settings);
  gather::GatherStores own = gather_stores(settings);
  const bool keeps = stores.cache && stores.cache->rays();
  LUXEL_TRY(light::LightLayers layers, layers_of(in, settings, keeps));
  const light::LightLayers* told_apart = layers.size() > 0 ? &layers : nullptr;
  std::optional<gather::Earlier> earlier;
  if (KeptBake* found = stores.cache ? stores.cache->found() : nullptr) {
    const scene::SceneChange& change = stores.cache->change();
    const LightUpdate update = light_update(*found, change, in.scene);
    // Layers that are asked for are those of now: a light that is out has none, another name
    // counts.
    const bool same_layers = settings.layers == light::LayerMode::none ||
                             layers_of_lights(in.scene, in.lights, layers) == found->layers;
    if (is_sum_of_layers(update, change) && same_layers) {
      TexelLight out = sum_of_layers(*found, update);
      out.layers = std::move(layers.layers);
      if (settings.layers == light::LayerMode::none) drop_layers(out);
      return out;
    }
    if (const RecordFile* rays = stores.cache->found_rays(progress))
      earlier = earlier_of(*found, *rays, update, change, in, told_apart);
  }
  const uint64_t bytes =
      bytes_of_gather(in, settings, stores, bool(observer.on_estimate), layers.size()) +
      (stores.team ? 2 * kTeamBytesAtATime : 0);
  LUXEL_TRY(own.hit_memory_bytes, memory_to_spare(in, settings, bytes, kMinHitBytes));
  std::vector<std::string> warnings;
  if (earlier)
    own.earlier = &*earlier;
  else
    LUXEL_TRY_STATUS(look_ahead(in, settings, stores, own, params, warnings, progress));
  own.parts = stores.parts, own.team = stores.team;  // not for the trial
  if (keeps) own.keep = stores.cache->rays();
  const GatherCall call{in, told_apart, params, own,
                        gather::GatherObserver{.on_estimate = observer.on_estimate,
                                               .guess = observer.guess,
                                               .is_watched = observer.is_watched,
                                               .on_bounce = observer.on_bounce,
                                               .on_traced = observer.on_traced}};
  TookPart part{.device = {}, .warnings = std::move(warnings)};
  LUXEL_TRY(gather::Gather result, gather_on_any(stores.device, call, part, progress));
  const light::LightLayers all_layers = layers;
  const gather::SourceLight sources = std::move(result.sources);
  TexelLight out = light_of(result, layers);
  out.device = std::move(part.device);
  if (keeps) stores.cache->keep(kept_bake(in, all_layers, result, out));
  if (settings.layers == light::LayerMode::none) drop_layers(out);
  if (settings.max_error > 0 || settings.time_budget_s > 0)
    warn_about_rounds(settings, params, result, part.warnings);
  out.warnings = std::move(part.warnings);
  take_part(settings.light, sources, out);
  return out;
}

}  // namespace

Solver gather_solver() {
  return {.name = "gather",
          .can = {.samples = true,
                  .direct_samples = true,
                  .supersample = true,
                  .quality = true,
                  .errors = true,
                  .noise = true,
                  .layers = true,
                  .direct = true,
                  .scatters = true,
                  .parts = true,
                  .teams = true,
                  .keeps = true,
                  .device = true},
          .solve = solve_gather,
          .plan = plan_gather,
          .usual = usual_gather};
}

}  // namespace luxel::pipeline
