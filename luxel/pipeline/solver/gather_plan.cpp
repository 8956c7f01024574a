#include "luxel/pipeline/solver/gather_plan.h"

#include <algorithm>

#include "luxel/base/machine_load.h"
#include "luxel/base/parallel.h"
#include "luxel/base/process_memory.h"
#include "luxel/pipeline/solver/gather.h"
#include "luxel/pipeline/solver/gather_memory.h"
#include "luxel/pipeline/solver/memory.h"
#include "luxel/solve/gather/bounce/bounces.h"
#include "luxel/solve/gather/forecast/forecast_rounds.h"

namespace luxel::pipeline {
namespace {

/// A trial for a plan lights one texel in so many: a percent of the bake, but some thousand of
/// them.
constexpr int kPlanPart = 100;
/// A trial of the rounds to an error lights one texel in so many: more of them, because some get
/// many times the rays of others.
constexpr int kRoundsPart = 16;
/// The time of one core per ray in most scenes [s], and the parts of it.
constexpr double kRaySeconds = 1.9e-7;
constexpr double kDirectPart = 0.12, kSupersamplePart = 0.12, kTracePart = 0.76;
/// Over what rays take: bounces in most scenes; the light of the denoiser's check; the walls that
/// part its texels, which a ray beside each finds.
constexpr double kBouncesOverRays = 0.08, kCheckOverRays = 0.04, kWallsOverRays = 0.03;
/// The check looks at so many texels at least, which is this many times that part of small maps.
double more_check(double texels) { return std::max(1.0, 1e5 / std::max(texels, 1.0)); }
/// Charts are looked across, too [s of one core]; and a layer is bounced as the whole is, but
/// seldom by sparse sweeps.
constexpr double kWallSecondsPerChart = 1e-4, kLayerOverBounces = 1.3;

}  // namespace

std::vector<Stage> stages_of(const gather::Forecast& forecast, const BakeSettings& settings,
                             const BakeSize& size) {
  std::vector<Stage> stages{{"direct light", forecast.direct_s},
                            {"supersample", forecast.supersample_s},
                            {"trace rays", forecast.trace_s},
                            {"bounces", forecast.bounces_s}};
  const double rays_s = forecast.direct_s + forecast.trace_s;
  if (size.layers > 0)
    stages.push_back({"layers", kLayerOverBounces * size.layers * forecast.bounces_s});
  if (settings.denoise)
    stages.push_back({"check", more_check(size.texels) * kCheckOverRays * rays_s});
  if (settings.repair_leaks)
    stages.push_back(
        {"walls", kWallsOverRays * rays_s + kWallSecondsPerChart * size.charts * machine_load() /
                                                double(thread_count())});
  return stages;
}

std::vector<Stage> usual_gather(const BakeSettings& settings, double texels) {
  if (adds_rounds(settings) || !settings.part.is_all()) return {};
  const double rays = texels * (settings.samples + first_direct_samples(settings));
  const double seconds = kRaySeconds * rays;
  std::vector<Stage> stages{{"direct light", kDirectPart * seconds},
                            {"supersample", kSupersamplePart * seconds},
                            {"trace rays", kTracePart * seconds},
                            {"bounces", kBouncesOverRays * seconds}};
  // No walls: those of the layout would be taken for these.
  if (settings.denoise)
    stages.push_back({"check", (more_check(texels) * kCheckOverRays + kWallsOverRays) * seconds});
  return stages;
}

Result<Plan> plan_gather(const light::TexelScene& in, const BakeSettings& settings,
                         Progress& progress) {
  Plan out;
  out.resolution = in.map.resolution, out.texels = in.elements.size();
  progress.finish();
  out.stages = progress.stages();
  const uint64_t bytes = bytes_of_gather(in, settings, {}, false);
  const double besides_hits = double(resident_bytes() + bytes);
  LUXEL_TRY(const uint64_t hit_memory, memory_to_spare(in, settings, bytes, 0));
  const gather::GatherParams params = gather_params(settings);
  const gather::GatherStores stores = gather_stores(settings);
  LUXEL_TRY(const gather::Forecast forecast,
            gather::forecast(in, params, stores, {.part = kPlanPart}, progress));
  const BakeSize size = bake_size(in, settings);
  for (const Stage& stage : stages_of(forecast, settings, size)) out.stages.push_back(stage);
  gather::RoundsForecast rounds;
  if (settings.max_error > 0) {
    LUXEL_TRY(rounds, gather::forecast_rounds(in, params, stores, kRoundsPart, progress));
    out.stages.push_back({"rounds", rounds.trace_s + rounds.bounces_s});
  }
  for (const Stage& stage : stages_after_solving(size, settings)) out.stages.push_back(stage);
  for (const Stage& stage : out.stages) out.seconds += stage.seconds;
  if (settings.time_budget_s > 0) out.seconds = std::min(out.seconds, settings.time_budget_s);
  out.rays = forecast.rays + rounds.rays;
  const double hits = forecast.hit_bytes + rounds.hit_bytes;
  const double kept = std::min(hits, double(hit_memory));
  const double copy = gather::copy_bytes(hits, settings.max_error > 0 ? 0 : settings.samples);
  out.memory_bytes = besides_hits + std::min(kept + copy, double(hit_memory)),
  out.scratch_bytes = hits - kept;
  return out;
}

}  // namespace luxel::pipeline
