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
/// Rays that are added where the denoiser would leave light mottled, over the first ones: in most
/// scenes.
constexpr double kAddedOverFirst = 0.65;
/// Over what rays take: bounces in most scenes; the light of the denoiser's check.
constexpr double kBouncesOverRays = 0.08, kCheckOverRays = 0.04;
/// The sides of walls are found between neighbours [s of one core].
constexpr double kSideSecondsPerTexel = 2e-6;
/// The check looks at so many texels at least, which is this many times that part of small maps.
double more_check(double texels) { return std::max(1.0, 1e5 / std::max(texels, 1.0)); }
/// A layer is bounced as the whole is, but seldom by sparse sweeps.
constexpr double kLayerOverBounces = 1.3;

double added_over_first(const BakeSettings& settings) {
  return gather_params(settings).more_rays && !settings.keep ? kAddedOverFirst : 0;
}

}  // namespace

std::vector<Stage> stages_of(const gather::Forecast& forecast, const BakeSettings& settings,
                             const BakeSize& size) {
  const double sides_s =
      kSideSecondsPerTexel * size.texels * machine_load() / double(thread_count());
  std::vector<Stage> stages{{"wall sides", sides_s},
                            {"direct light", forecast.direct_s},
                            {"supersample", forecast.supersample_s},
                            {"trace rays", forecast.trace_s}};
  if (const double added = added_over_first(settings); added > 0)
    stages.push_back({"trace rays", added * forecast.trace_s});
  stages.push_back({"bounces", forecast.bounces_s});
  const double rays_s = forecast.direct_s + forecast.trace_s;
  if (size.layers > 0)
    stages.push_back({"layers", kLayerOverBounces * size.layers * forecast.bounces_s});
  if (settings.denoise)
    stages.push_back({"check", more_check(size.texels) * kCheckOverRays * rays_s});
  return stages;
}

std::vector<Stage> usual_gather(const BakeSettings& settings, double texels) {
  if (adds_rounds(settings) || !settings.part.is_all()) return {};
  const double rays = texels * (settings.samples + first_direct_samples(settings));
  const double seconds = kRaySeconds * rays;
  std::vector<Stage> stages{{"wall sides", kSideSecondsPerTexel * texels},
                            {"direct light", kDirectPart * seconds},
                            {"supersample", kSupersamplePart * seconds},
                            {"trace rays", kTracePart * seconds}};
  if (const double added = added_over_first(settings); added > 0)
    stages.push_back({"trace rays", added * kTracePart * seconds});
  stages.push_back({"bounces", kBouncesOverRays * seconds});
  if (settings.denoise) stages.push_back({"check", more_check(texels) * kCheckOverRays * seconds});
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
