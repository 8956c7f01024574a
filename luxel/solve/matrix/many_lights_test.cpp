#include "luxel/solve/matrix/many_lights.h"

#include <gtest/gtest.h>

#include "luxel/base/parallel.h"
#include "luxel/solve/matrix/matrix_test_support.h"

namespace luxel::matrix {
namespace {

using testing::Cut;

/// A room, and more lights than share a walk: one more than twice as many.
struct ManyLightsRoom {
  Cut cut{scene::cornell_box(), 300};
  FormFactors factors = cut.reciprocal_factors(256);
  ManyLights sent;

  ManyLightsRoom() {
    for (uint64_t t = 0; t < 33; ++t) sent.push_back(testing::random_light(cut.size(), t + 1));
  }
  SentByMany all() const {
    return {sent, cut.patches().elements.reflectance, cut.patches().area_m2};
  }
  Sent one(size_t light, int bounces) const {
    return {sent[light], cut.patches().elements.reflectance, cut.patches().area_m2, bounces};
  }
  Multiply product() const {
    return [this](auto b, auto e) { multiply(factors, b, e); };
  }
};

// Light by light, the same sums in the same order.
TEST(ManyLights, BouncesAreThoseOfOneLightAfterAnother) {
  const ManyLightsRoom room;
  Progress progress;
  const auto got = count_bounces(room.factors, room.all(), 3, progress);
  ASSERT_TRUE(got);
  std::vector<Rgb> want(room.cut.size());
  BounceScratch scratch = make_bounce_scratch(want.size(), 0);
  for (size_t t = 0; t < room.sent.size(); ++t) {
    count_bounces(room.product(), room.one(t, 3), want, scratch);
    ASSERT_EQ((*got)[t], want) << t;
  }
}

TEST(ManyLights, SweepsAreThoseOfOneLightAfterAnother) {
  const ManyLightsRoom room;
  const CoarseScene coarse =
      make_coarse_scene(room.factors, room.cut.patched.tree, room.cut.patches().area_m2,
                        room.cut.patches().elements.reflectance, 16);
  std::vector<ManyLights> seen;  // after 1, 2, 3 sweeps
  const auto see = [&](const ManyLights& now) {
    seen.push_back(now);
    return seen.size() < 3;
  };
  Progress progress;
  const auto got = all_bounces(room.factors, coarse, room.all(), 9, see, progress);
  ASSERT_TRUE(got);
  ASSERT_EQ(seen.size(), 3u);
  EXPECT_EQ(*got, seen.back());
  std::vector<Rgb> want(room.cut.size());
  BounceScratch scratch = make_bounce_scratch(want.size(), coarse.count());
  for (int sweeps = 1; sweeps <= 3; ++sweeps)
    for (size_t t = 0; t < room.sent.size(); ++t) {
      all_bounces(room.product(), coarse, room.one(t, -1), sweeps, want, scratch);
      ASSERT_EQ(seen[size_t(sweeps) - 1][t], want) << sweeps << " " << t;
    }
}

TEST(ManyLights, CanBeCancelled) {
  const ManyLightsRoom room;
  Progress progress;
  progress.request_cancel();
  const auto got = count_bounces(room.factors, room.all(), 3, progress);
  ASSERT_FALSE(got);
  EXPECT_EQ(got.error().code, ErrorCode::cancelled);
}

}  // namespace
}  // namespace luxel::matrix
