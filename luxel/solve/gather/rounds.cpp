// Rounds of more rays, where an error is asked for or time is left.
#include <algorithm>

#include "luxel/solve/gather/budget/adaptive.h"
#include "luxel/solve/gather/steps.h"

namespace luxel::gather {
namespace {

/// What the last bounces take, over those of a round: from a tolerance of 1e-2 to one of 1e-4 is as
/// far as from 1 to 1e-2, and sweeps over all rays take more than sparse ones.
constexpr double kFineOverRough = 4;
/// A round that adds less than this part of the rays is not worth its bounces.
constexpr double kSmallestRound = 1.0 / 16;
/// The part of a round's rays that may be shadow rays.
constexpr double kDirectShare = 0.25;
/// What noise may have of an error when texels cost more than the rest of its square: half of it.
constexpr float kNoiseWithTexels = 0.70710678f;

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

}  // namespace

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

}  // namespace luxel::gather
