// Rounds of more rays, where an error is asked for or time is left.
#include <algorithm>
#include <cmath>

#include "luxel/base/share_out.h"
#include "luxel/solve/gather/budget/adaptive.h"
#include "luxel/solve/gather/budget/guide.h"
#include "luxel/solve/gather/steps.h"

namespace luxel::gather {
namespace {

/// Time of the last bounces over that of a round's bounces: from a tolerance of 1e-2 to one of 1e-4
/// is as far as from 1 to 1e-2, and sweeps over all rays take more than sparse ones.
constexpr double kFineOverRough = 4;
/// A round that adds less than this part of the rays is not worth its bounces.
constexpr double kSmallestRound = 1.0 / 16;
/// The part of a round's rays that may be shadow rays.
constexpr double kDirectShare = 0.25;
/// The part of an error that noise may have when texels cost more than the rest of its square: half
/// of the square.
constexpr float kNoiseWithTexels = 0.70710678f;
constexpr double kNoiseWithTexels2 = 0.5;
/// The part of the squared noise that is allowed at which plans aim. A plan that is right to a few
/// per cent ends there at once, and needs no other round for the rest.
constexpr double kAimedAt = 0.94;
/// Over the square of the error that is asked for. What is nearly reached takes few rays.
constexpr double kNoiseWorthAGuide = 3;

/// The part of the time left that is not planned for: rounds so far tell how long the next takes.
constexpr double kSpareTime = 0.1;
/// The light that answers are made of, over all rays before it.
constexpr double kAnswersOverRays = 0.05;

/// Rays that the next round may have, so that it and the last bounces end in time. Tracing takes as
/// long per ray as in the last round, and bounces grow with the number of all rays.
double affordable_rays(const GatherParams& params, const Progressive& light, double seconds_left) {
  const double rays = double(light.hits.rays), bounces_s = light.bounced_s * (1 + kFineOverRough);
  if (seconds_left <= 0) return 0;
  // Where all rays were found, some are traced to know what they take.
  if (light.traced_rays == 0) return kSmallestRound * rays;
  const double per_ray = light.traced_s / double(std::max<uint64_t>(light.traced_rays, 1));
  const double answers_s = params.tells_answers ? kAnswersOverRays * per_ray : 0;
  const double fixed_s = bounces_s + 2 * light.judged_s + answers_s * rays;
  const double most =
      ((1 - kSpareTime) * seconds_left - fixed_s) / (per_ray + answers_s + bounces_s / rays);
  // A machine may become busier within a long round, and shorter ones tell: no round takes more
  // than half of what is left, unless it is a small one.
  return most > 0.5 * rays ? std::max(0.5 * most, 0.5 * rays) : most;
}

/// Samples that elements lack.
uint64_t added_samples(const TracedHits& hits, std::span<const uint16_t> target) {
  uint64_t sum = 0;
  for (size_t i = 0; i < target.size(); ++i)
    sum += uint64_t(std::max(0, int(target[i]) - int(hits.samples[i])));
  return sum;
}

/// Tells the watcher what is still to come, when an error is asked for.
void expect_rounds(const GatherParams& params, std::span<const uint16_t> target,
                   const Progressive& light, Progress& progress) {
  if (light.traced_samples == 0) return;  // nobody knows yet what they take
  std::vector<uint64_t> rounds;
  if (params.error_measure == ErrorMeasure::p95)
    rounds = rounds_to_come(light.errors.all, light.errors.gathered, params.max_error,
                            params.max_samples, light.hits.samples);
  const double before = double(sum_of(light.hits.samples));
  if (rounds.empty()) rounds.push_back(0);
  rounds.front() = added_samples(light.hits, target);  // that is known
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

/// The error that is asked about.
double error_of(ErrorMeasure measure, const LightErrors& errors) {
  return measure == ErrorMeasure::rms ? errors.expected.rms() : double(errors.p95);
}

/// True: the light is known well enough, or no ray helps, as the rest is the error of texels.
bool is_known(const GatherParams& params, const LightErrors& errors) {
  const double noise = params.error_measure == ErrorMeasure::rms ? std::sqrt(errors.expected.noise)
                                                                 : double(errors.noise_p95);
  return error_of(params.error_measure, errors) <= double(params.max_error) ||
         noise <= double(kNoiseWithTexels * params.max_error);
}

/// Indirect light gets more rays, direct light more shadow rays, where either is off by too much.
/// `affordable` rays at most.
RoundPlan plan_p95(const Request& in, double affordable, const Progressive& light) {
  const GatherParams& params = in.params;
  const float each = error_of_part(params.max_error);
  RoundPlan out{next_samples(light.errors.gathered, each, params.max_samples, light.hits.samples),
                {}};
  float direct_above = each;
  if (std::isfinite(affordable)) {
    const double rays_per_sample = double(light.hits.rays) / double(sum_of(light.hits.samples));
    keep_affordable(light.errors.gathered,
                    uint64_t((1 - kDirectShare) * affordable / rays_per_sample), light.hits.samples,
                    out.samples);
    direct_above = affordable_error(light.errors.direct, each, kDirectShare * affordable,
                                    in.supersample_params(), light.levels);
  }
  out.finer = elements_above(light.errors.direct, direct_above);
  return out;
}

/// Makes values add up to `sum`, unless they are none.
void scale_to(double sum, std::span<float> values) {
  double all = 0;
  for (const float v : values) all += double(v);
  if (!(all > 0)) return;
  for (float& v : values) v = float(double(v) * (sum / all));
}

/// Rays of each kind where the sum of squared errors falls most for them, until what is left of it
/// beside that of texels is as asked for.
RoundPlan plan_rms(const Request& in, double affordable, const Progressive& light) {
  const GatherParams& params = in.params;
  const std::vector<Rgb>& e = light.bounced.irradiance;
  std::vector<float> gathered = variances_of(light.errors.gathered, e),
                     direct = variances_of(light.errors.direct, e);
  // All noise is 1: what of it is whose has been measured.
  scale_to(1 - light.share_of_direct, gathered);
  scale_to(light.share_of_direct, direct);
  const ExpectedSquares& now = light.errors.expected;
  const double asked = double(params.max_error) * double(params.max_error);
  const double allowed =
      now.noise > 0 ? kAimedAt * std::max(asked - now.texels, asked * kNoiseWithTexels2) / now.noise
                    : 0;
  return plan_rms_round({gathered, direct, light.hits.samples, light.levels, &light.hits}, allowed,
                        affordable, costs_of(in, light), params.max_samples);
}

/// True: noise is so far above the error asked for that it is worth rays to know where it comes
/// from.
bool asks_for_guide(const Request& in, const Progressive& light) {
  if (in.knows_rays_by_number()) return false;
  const double asked = double(in.params.max_error) * double(in.params.max_error);
  return light.hits.guide.of_element.empty() &&
         light.errors.expected.noise > kNoiseWorthAGuide * asked;
}

/// The guide, once the light of the first round is known. Errors: cancelled.
Status find_guide(const Request& in, Progressive& light, Progress& progress) {
  if (!asks_for_guide(in, light)) return {};
  Progress own;  // its stages are not those of the bake
  LUXEL_TRY(light.hits.guide,
            make_guide(in.scene, in.sides,
                       {light.hits, in.behind, light.bounced.irradiance, in.stores.team},
                       in.params.seed, own));
  return stopped(progress);
}

}  // namespace

bool begin_anew(std::span<const uint8_t> anew, TracedHits& hits) {
  bool any = false;
  for (size_t i = 0; i < anew.size(); ++i)
    if (anew[i] > 0) begin_guided(hits, i, anew[i]), any = true;
  return any;
}

RayCosts costs_of(const Request& in, const Progressive& light) {
  const GatherParams& params = in.params;
  const double points = double(params.supersample * std::max(params.direct_samples / 8, 8));
  return ray_costs(
      light.rays_per_ray,
      light.shadow_rays_at_sample > 0 ? light.shadow_rays_at_sample : params.direct_samples,
      light.shadow_rays_at_points > 0 ? light.shadow_rays_at_points : points);
}

Result<bool> next_round(const Request& in, double seconds_left, Progressive& light,
                        Progress& progress) {
  const GatherParams& params = in.params;
  if (is_known(params, light.errors)) return false;
  // A time budget takes both kinds of rays back to what it can pay for, and ends the rounds.
  double affordable = INFINITY;
  if (params.seconds > 0) {
    LUXEL_TRY(affordable,
              first_of(in.stores.team, affordable_rays(params, light, seconds_left), progress));
    if (affordable < kSmallestRound * double(light.hits.rays)) return false;
  }
  const bool is_rms = params.error_measure == ErrorMeasure::rms;
  if (is_rms) LUXEL_TRY_STATUS(find_guide(in, light, progress));
  const RoundPlan plan = is_rms ? plan_rms(in, affordable, light) : plan_p95(in, affordable, light);
  const bool begins_anew = begin_anew(plan.anew, light.hits);
  if (params.seconds <= 0) expect_rounds(params, plan.samples, light, progress);
  LUXEL_TRY(const size_t finer, refine_direct(in.scene, plan.finer, in.supersample_params(),
                                              light.levels, light.direct, progress));
  if (!begins_anew && plan.samples == light.hits.samples) return finer > 0;
  LUXEL_TRY_STATUS(trace_round(in, plan.samples, light, progress));
  return true;
}

}  // namespace luxel::gather
