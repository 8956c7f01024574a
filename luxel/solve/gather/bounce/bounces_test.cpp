// Bounces end at the same fixed point, whichever way they take to it.
#include "luxel/solve/gather/bounce/bounces.h"

#include <gtest/gtest.h>

#include "luxel/base/random.h"
#include "luxel/scene/shapes.h"
#include "luxel/solve/gather/bounce/sweep.h"
#include "luxel/solve/gather/gather_test_support.h"
#include "luxel/solve/gather/trace/trace_hits.h"

namespace luxel::gather {
namespace {

/// A room with a box under a lamp, its rays traced and its direct light known.
struct Traced {
  std::unique_ptr<Room> room;
  TracedHits hits;
  std::vector<Rgb> direct;

  /// The light after all bounces, to a tolerance far below that of bakes.
  Bounced bounced(BounceParams params) const {
    params.tolerance = 1e-6f;
    Progress progress;
    auto out = bounce(room->map, room->elements, hits, direct, {}, params, progress);
    EXPECT_TRUE(out) << out.error().message;
    return std::move(*out);
  }
};

Traced traced(int samples) {
  scene::Scene scene;
  const uint32_t white = scene::add_material(scene, "white", {0.7f, 0.6f, 0.5f}, {});
  scene::Mesh room, box;
  scene::add_box(room, {-2, 0, -2}, {2, 3, 2}, white);
  for (auto& t : room.triangles) std::swap(t[1], t[2]);
  scene::place(scene, std::move(room));
  scene::add_box(box, {-1, 0, -1}, {0, 1, 0}, white);
  scene::place(scene, std::move(box));
  scene::PunctualLight lamp;
  lamp.position = {0, 2, 0}, lamp.intensity = {3, 2, 1};
  scene.lights.push_back(lamp);
  Traced out{lay_out(std::move(scene), 48), {}, {}};
  const Room& r = *out.room;
  Progress progress;
  auto hits = trace_hits(trace_scene(scene_of(r)), samples, {}, progress);
  EXPECT_TRUE(hits);
  out.hits = std::move(*hits);
  auto direct = light::direct_light(r.scene, r.elements, r.lights, *r.tracer, {}, progress);
  EXPECT_TRUE(direct);
  out.direct = std::move(direct->irradiance);
  return out;
}

// Sweeps over a copy of some rays, and over all rays in memory, are the same sweeps.
TEST(Bounces, AreTheSameBitsWithoutRoomForACopy) {
  const Traced t = traced(256);
  const Bounced with = t.bounced({}), without = t.bounced({.spare_bytes = 0});
  EXPECT_EQ(with.irradiance, without.irradiance);
  EXPECT_EQ(with.variance, without.variance);
  EXPECT_EQ(with.split_variance, without.split_variance);
  EXPECT_EQ(with.sweeps, without.sweeps);
}

// A run of so many bounces ends with the same bits; nothing comes after who has enough.
TEST(Bounces, AreToldOneByOne) {
  const Traced t = traced(16);
  const auto told = [&](int bounces, size_t enough) {
    std::vector<std::vector<Rgb>> out;
    Progress progress;
    const auto take = [&](std::span<const Rgb> e) {
      out.emplace_back(e.begin(), e.end());
      return out.size() < enough;
    };
    EXPECT_TRUE(bounce_by_bounce(t.room->map, t.room->elements, t.hits, t.direct, {}, bounces, take,
                                 progress));
    return out;
  };
  const auto all = told(-1, 4);
  ASSERT_EQ(all.size(), 4u);
  for (int k = 0; k < 4; ++k) EXPECT_EQ(all[size_t(k)], t.bounced({.bounces = k}).irradiance) << k;
  EXPECT_EQ(told(2, 4).size(), 3u) << "there is no more light";
  EXPECT_EQ(told(0, 4).size(), 1u);
}

TEST(SubsampledHits, AreMadeWhereTheyFit) {
  const Traced t = traced(64);
  Progress progress;
  const auto none = subsample(t.hits, 16, 1000, progress);
  ASSERT_TRUE(none);
  EXPECT_FALSE(*none);
  const auto all = subsample(t.hits, 16, UINT64_MAX, progress);
  ASSERT_TRUE(all && *all);
  double weight = 0, hits = 0;
  for (const SubsampledHits::Tile& tile : (*all)->tiles) {
    ASSERT_EQ(tile.weight.size(), tile.hits.size());
    for (const float w : tile.weight) weight += double(w);
    hits += double(tile.hits.size());
  }
  // All stand for all; of 64 rays, nearly all of which meet something, there are 4.
  const double stored = double(t.hits.bytes_in_memory()) / double(sizeof(StoredHit));
  EXPECT_NEAR(weight, stored, 1e-6 * stored);
  EXPECT_NEAR(hits, stored / 16, 0.05 * stored / 16);
}

/// Root mean square difference over the mean.
double difference(const Bounced& a, const Bounced& b) {
  double sum2 = 0, mean = 0;
  for (size_t i = 0; i < a.irradiance.size(); ++i) {
    const double d = double(luminance(a.irradiance[i])) - double(luminance(b.irradiance[i]));
    sum2 += d * d, mean += double(luminance(b.irradiance[i]));
  }
  return std::sqrt(sum2 * double(a.irradiance.size())) / mean;
}

// A first change that is exact, one that is known of every other element, and one that is wrong.
TEST(Bounces, EndWhereTheyDoWithoutAFirstChange) {
  const Traced t = traced(256);
  const size_t n = t.direct.size();
  const Bounced expected = t.bounced({});
  std::vector<Rgb> start = expected.irradiance, change(n);
  for (size_t i = 0; i < n; ++i) start[i] = start[i] * (1 + 0.3f * std::sin(0.01f * float(i)));
  Bounced once = t.bounced({.bounces = 0});
  ASSERT_EQ(once.irradiance.size(), n);
  // By one sweep over all rays, as a run of one bounce from that start makes it.
  RadiosityMap m = empty_radiosity_map(t.room->map.resolution);
  fill_radiosity(m, t.room->map, t.room->elements, t.hits, {}, start);
  Progress progress;
  std::vector<Rgb> swept = start;
  Sweep sweep{.direct = t.direct,
              .irradiance = swept,
              .variance = once.variance,
              .split_variance = once.split_variance};
  ASSERT_TRUE(run_sweep(m, t.hits, sweep, progress));
  for (size_t i = 0; i < n; ++i) change[i] = swept[i] - start[i];
  std::vector<uint8_t> none(n, 0), half(n);
  for (size_t i = 0; i < n; ++i) half[i] = i % 2;
  std::vector<Rgb> wrong = change;
  for (Rgb& c : wrong) c = c * -3.0f;
  std::vector<Rgb> known = change;  // unknown changes are not looked at
  for (size_t i = 0; i < n; ++i)
    if (half[i]) known[i] = {1e3f, 1e3f, 1e3f};
  const Bounced from_start = t.bounced({.start = start});
  const auto with = [&](std::span<const Rgb> first, std::span<const uint8_t> unknown) {
    return t.bounced({.start = start, .first_change = first, .unknown = unknown});
  };
  const Bounced exact = with(change, none), partly = with(known, half), bad = with(wrong, none);
  // The tolerance is 1e-6 of the mean each, and floats round to 6e-8 of light up to 30 times that.
  constexpr double kTolerance = 5e-6;
  for (const Bounced* b : {&from_start, &exact, &partly, &bad})
    EXPECT_LT(difference(*b, expected), kTolerance);
  EXPECT_EQ(exact.sweeps, from_start.sweeps - 1) << "the first is known";
  EXPECT_EQ(partly.sweeps, exact.sweeps);
  for (const float v : exact.variance) EXPECT_GE(v, 0.0f);
  EXPECT_EQ(exact.variance.size(), n);
}

}  // namespace
}  // namespace luxel::gather
