// Direct light of a sun through leaves, the hardest case: nearly every texel has an edge of a
// shadow.
#include <gtest/gtest.h>

#include <cmath>

#include "luxel/scene/procedural.h"
#include "luxel/solve/gather/gather_test_support.h"

namespace luxel::gather {
namespace {

/// Errors of the direct light and of the rest, over the mean light, as two seeds tell.
struct ErrorOfParts {
  double direct = 0, gathered = 0;
};
ErrorOfParts errors_of(const Room& room, GatherParams params) {
  const Gather a = solve(room, params);
  params.seed = 2;
  const Gather b = solve(room, params);
  ErrorOfParts sum2;
  double mean = 0;
  for (size_t i = 0; i < a.irradiance.size(); ++i) {
    const double direct = double(luminance(a.direct[i] - b.direct[i]));
    const double all = double(luminance(a.irradiance[i] - b.irradiance[i]));
    sum2.direct += direct * direct, sum2.gathered += (all - direct) * (all - direct);
    mean += double(luminance(a.irradiance[i]));
  }
  const double n = double(a.irradiance.size());
  mean /= n;
  return {std::sqrt(sum2.direct / (2 * n)) / mean, std::sqrt(sum2.gathered / (2 * n)) / mean};
}

TEST(BalanceDirect, NeitherPartOfTheErrorIsMoreThanTwiceTheOther) {
  const auto room = lay_out(scene::foliage(), 96);
  GatherParams params = with_samples(64, 8);
  params.supersample = 8;
  const ErrorOfParts fixed = errors_of(*room, params);
  EXPECT_GT(fixed.direct, 2 * fixed.gathered);  // else there is nothing to show
  params.more_shadow_rays = params.more_points = true;
  const ErrorOfParts balanced = errors_of(*room, params);
  EXPECT_LT(balanced.direct, 2 * balanced.gathered);
}

}  // namespace
}  // namespace luxel::gather
