// Direct light that is as well known as the rest.
#include <algorithm>
#include <cmath>

#include "luxel/solve/gather/bounce/ambient.h"
#include "luxel/solve/gather/bounce/sweep.h"
#include "luxel/solve/gather/budget/adaptive.h"
#include "luxel/solve/gather/steps.h"

namespace luxel::gather {
namespace {

/// One element in so many tells how well gathered light is known: a sum over thousands of them.
constexpr size_t kElementsPerChecked = 16;
/// Shadow rays cost no more than so many times what the indirect rays did, however little those
/// have left to know, as in a black room.
constexpr double kMostOverRays = 2;
/// Rounds of looking finer: each gets so near to what is allowed that few follow.
constexpr int kMostRounds = 6;

/// The sum over `values` of elements that no solid hides.
double sum_of_visible(std::span<const float> values, const TracedHits& hits) {
  double sum = 0;
  for (size_t i = 0; i < values.size(); ++i)
    if (!is_hidden(hits, i)) sum += double(values[i]);
  return sum;
}

/// About the sum of variances of all gathered light, before it is bounced: by what some elements
/// gather of a guess. Errors: the file of hits cannot be read, cancelled.
Result<double> gathered_variance(const Request& in, const Progressive& light, Progress& progress) {
  const light::TexelScene& scene = in.scene;
  const size_t n = light.hits.size();
  std::vector<Rgb> guess = with_ambient(scene.elements, light.direct.irradiance);
  RadiosityMap sent = empty_radiosity_map(scene.map.resolution);
  fill_radiosity(sent, scene.map, scene.elements, light.hits, in.behind, guess);
  std::vector<uint8_t> chosen(n);
  for (size_t i = 0; i < n; i += kElementsPerChecked) chosen[i] = 1;
  std::vector<float> variance(n), split(n);
  Sweep sweep{.direct = light.direct.irradiance,
              .irradiance = guess,
              .variance = variance,
              .split_variance = split,
              .only = chosen};
  LUXEL_TRY_STATUS(run_sweep(sent, light.hits, sweep, progress));
  LUXEL_TRY_STATUS(give_variances(light.hits, variance, split, progress));
  return sum_of_visible(split, light.hits) * double(kElementsPerChecked);
}

/// Elements that may be looked at more finely keep their variance; the others get 0.
void keep_only_what_may_be_finer(const Request& in, const light::DirectLevels& levels,
                                 std::vector<float>& variance) {
  for (size_t i = 0; i < variance.size(); ++i) {
    const bool may = levels.averaged[i] ? in.params.more_points : in.params.more_shadow_rays;
    if (!may || !can_be_finer(levels, i)) variance[i] = 0;
  }
}

}  // namespace

Status balance_direct(const Request& in, Progressive& light, Progress& progress) {
  // Light of an earlier bake is as fine as that has made it: whoever builds on it asks for few
  // rays.
  if (in.adds_rounds() || !in.may_look_finer() || in.stores.earlier) return {};
  if (!(sum_of_visible(light.direct.split_variance, light.hits) > 0)) return {};
  LUXEL_TRY(const double allowed, gathered_variance(in, light, progress));
  const double samples = double(std::max<uint64_t>(sum_of(light.hits.samples), 1));
  const RayCosts costs = costs_of(in, light);
  double affordable = kMostOverRays * samples * costs.sample;
  const std::vector<float> none(light.hits.size());
  for (int round = 0; round < kMostRounds; ++round) {
    if (sum_of_visible(light.direct.split_variance, light.hits) <= allowed) return {};
    std::vector<float> variance = pooled_variances(
        in.scene.atlas, in.scene.map, {light.direct.variance, light.direct.split_variance});
    double stays = sum_of_visible(variance, light.hits);
    for (size_t i = 0; i < variance.size(); ++i)
      if (is_hidden(light.hits, i)) variance[i] = 0;
    keep_only_what_may_be_finer(in, light.levels, variance);
    stays -= sum_of_visible(variance, light.hits);
    const RoundPlan plan = plan_rms_round({none, variance, light.hits.samples, light.levels},
                                          std::max(allowed - stays, 0.0), affordable, costs, 0);
    const uint64_t before = light.direct.rays;
    LUXEL_TRY(const size_t finer, refine_direct(in.scene, plan.finer, in.supersample_params(),
                                                light.levels, light.direct, progress));
    if (finer == 0 || has_left_parts(in)) return {};
    affordable -= kShadowRay * double(light.direct.rays - before);
  }
  return {};
}

}  // namespace luxel::gather
