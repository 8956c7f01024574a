#include "solve/matrix/relighter.h"

#include <gtest/gtest.h>

#include <atomic>
#include <optional>
#include <thread>

#include "base/parallel.h"
#include "solve/matrix/codec.h"
#include "solve/matrix/matrix.h"
#include "solve/matrix/matrix_test_support.h"
#include "solve/matrix/relight.h"

namespace luxel::matrix {
namespace {

using testing::relative_error;
using Kind = scene::PunctualLight::Kind;

constexpr std::array kAllCodecs{CodecKind::hierarchical, CodecKind::lowrank, CodecKind::bc1,
                                CodecKind::dense32, CodecKind::dense16};

RelightParams small(CodecKind codec, float max_error = 0.01f) {
  RelightParams params;
  params.patches.count = 300;
  params.factors.rays_per_patch = 512;
  params.codec = codec, params.max_error = max_error;
  return params;
}

/// A scene and what relights it.
struct Stage {
  scene::Scene scene;
  trace::RayTracer tracer;
  RelightParams params;

  explicit Stage(scene::Scene s, const RelightParams& p = small(CodecKind::dense32, 1e-4f))
      : scene(std::move(s)), tracer(*trace::RayTracer::build(scene)), params(p) {}

  RelightData data(Target target = {}) const {
    Progress progress;
    auto out = make_relight_data(scene, tracer, std::move(target), params, progress);
    EXPECT_TRUE(out) << out.error().message;
    return out ? std::move(*out) : RelightData{};
  }
};

Relighter relighter_of(RelightData data, const RelighterParams& params = {}) {
  auto made = Relighter::make(std::move(data), params);
  EXPECT_TRUE(made) << made.error().message;
  return std::move(*made);
}

Relit relit(Relighter& relighter, const RelightLights& lights) {
  relighter.update(lights);
  return relighter.latest();
}

scene::PunctualLight point_at(Vec3 position, Rgb intensity) {
  scene::PunctualLight lamp;
  lamp.position = position, lamp.intensity = intensity;
  return lamp;
}
/// Both hang free in the Cornell box.
const scene::PunctualLight kLeft = point_at({0.45f, 0.4f, 0.15f}, {1, 0.5f, 0.25f});
const scene::PunctualLight kRight = point_at({0.1f, 0.45f, 0.4f}, {0.25f, 1, 0.5f});

/// Squares on the floor, facing up.
Target floor_places(float side_m) {
  Target target;
  target.kind = Target::Kind::vertices;
  for (int j = 0; j < 8; ++j)
    for (int i = 0; i < 8; ++i)
      target.position.push_back(
          {side_m * (float(i) + 0.5f) / 8, 0, side_m * (float(j) + 0.5f) / 8});
  target.normal.assign(target.position.size(), {0, 1, 0});
  target.geometric_normal = target.normal;
  return target;
}

/// I cos / d^2 at a place, unless a ray to the lamp meets something before it.
Rgb plain_light_at(const Stage& stage, const PatchPoint& at, const scene::PunctualLight& lamp) {
  const Vec3 to = lamp.position - at.position;
  const float along = dot(at.normal, to), d2 = dot(to, to);
  if (along <= 0) return {};
  const float diagonal_m = scene::world_bounds(stage.scene).diagonal();
  const Vec3 origin = trace::offset_origin(at.position, at.normal, diagonal_m);
  if (stage.tracer.closest_hit({origin, 0, to, INFINITY}).t < 0.999f) return {};
  return lamp.intensity * (along / (d2 * std::sqrt(d2)));
}

/// The same light without codecs: plain products until nothing is left to come.
struct Answer {
  std::vector<Rgb> direct, indirect;
};
Answer plain_answer(const Stage& stage, const RelightData& d,
                    std::span<const scene::PunctualLight> lamps, Rgb background, int products) {
  Progress progress;
  const auto prepared =
      prepare(stage.scene, stage.tracer, {stage.params.patches, stage.params.factors}, progress);
  EXPECT_TRUE(prepared);
  Answer out;
  std::vector<Rgb> sent, sky;
  for (size_t i = 0; i < d.size(); ++i) {
    Rgb direct{};
    for (uint32_t k = d.first_probe[i]; k < d.first_probe[i + 1]; ++k)
      for (const auto& lamp : lamps) direct += plain_light_at(stage, d.probe[k], lamp);
    direct = direct / float(d.first_probe[i + 1] - d.first_probe[i]);
    sky.push_back(background * (kPi * prepared->sky[i]));
    out.direct.push_back(direct);
    sent.push_back(d.emission[i] + d.reflectance[i] * (direct + sky[i]));
  }
  out.indirect.resize(d.size());
  for (int k = 0; k < products; ++k) {
    std::vector<Rgb> radiosity = sent;
    for (size_t i = 0; i < d.size(); ++i) radiosity[i] += d.reflectance[i] * out.indirect[i];
    out.indirect = testing::plain_product(prepared->factors, radiosity);
  }
  for (size_t i = 0; i < d.size(); ++i) out.indirect[i] += sky[i];
  return out;
}

TEST(Relighter, EveryCodecGivesTheLightOfPlainProducts) {
  for (const CodecKind codec : kAllCodecs) {
    const Stage stage(scene::cornell_box(), small(codec));
    Relighter relighter = relighter_of(stage.data());
    const RelightData& d = relighter.data();
    const std::array lamps{kLeft, kRight};
    // 0.78^100 = 2e-11 of the light is still to come.
    const Answer want = plain_answer(stage, d, lamps, {}, 100);
    const Relit got = relit(relighter, {lamps});
    // Sums of 8 floats.
    EXPECT_LT(relative_error(got.direct, want.direct, d.area_m2), 1e-6) << int(codec);
    // codec_error is the root mean square of such lamps; two at once seldom err by twice as much.
    EXPECT_LT(relative_error(got.indirect, want.indirect, d.area_m2), 2 * d.codec_error)
        << int(codec);
    EXPECT_GT(d.codec_error, 0) << int(codec);
    EXPECT_LT(d.codec_error, 0.03) << int(codec);
  }
}

TEST(Relighter, CountsBouncesWhenAskedTo) {
  for (const int bounces : {0, 3})
    for (const CodecKind codec : {CodecKind::dense32, CodecKind::lowrank, CodecKind::bc1}) {
      RelightParams params = small(codec);
      params.bounces = bounces;
      const Stage stage(scene::cornell_box(), params);
      Relighter relighter = relighter_of(stage.data());
      const RelightData& d = relighter.data();
      const Answer want = plain_answer(stage, d, {&kLeft, 1}, {0.5f, 1, 2}, bounces);
      const Relit got = relit(relighter, {{&kLeft, 1}, {}, {0.5f, 1, 2}});
      // Without codec, floats; see above.
      EXPECT_LT(relative_error(got.indirect, want.indirect, d.area_m2),
                std::max(2 * d.codec_error, 1e-6))
          << bounces << ", " << int(codec);
    }
}

TEST(Relighter, TheFurnaceGlowsEvenly) {
  // E = pi L / (1 - rho), whatever the codec; at places, too.
  const Rgb want = Rgb{2, 8.0f / 3, 3} * kPi;
  for (const CodecKind codec : kAllCodecs) {
    const Stage stage(scene::furnace_box({0.5f, 0.25f, 0}, {1, 2, 3}), small(codec));
    Relighter relighter = relighter_of(stage.data(floor_places(1)));
    const Relit got = relit(relighter, {});
    ASSERT_EQ(got.indirect_at_place.size(), 64u);
    for (const auto* list : {&got.indirect, &got.indirect_at_place}) {
      const std::vector<Rgb> even(list->size(), want);
      const std::vector<float> one(list->size(), 1.0f);
      // What lamps may lose is 1 %, root mean square; light from everywhere loses less.
      EXPECT_LT(relative_error(*list, even, one), 0.01) << int(codec);
      // Rows sum to 1 within 1e-3 (see Reciprocal.KeepsRowSums), which 1 / (1 - rho) doubles; half
      // of max_error more may be missing after the sweeps.
      for (const Rgb& e : *list)
        for (int c = 0; c < 3 && codec == CodecKind::dense32; ++c)
          EXPECT_NEAR(e[c], want[c], 7e-3f * want[c]);
    }
    for (const Rgb& e : got.direct) EXPECT_EQ(e, Rgb{});
  }
}

/// L per material as baked: B_e / pi, by area.
std::vector<Rgb> baked_radiance(const RelightData& d) {
  std::vector<Rgb> sum(d.material_name.size());
  std::vector<double> area(sum.size());
  for (size_t i = 0; i < d.size(); ++i)
    sum[d.material[i]] += d.emission[i] * d.area_m2[i], area[d.material[i]] += double(d.area_m2[i]);
  for (size_t m = 0; m < sum.size(); ++m) sum[m] = sum[m] / float(area[m] * double(kPi));
  return sum;
}

TEST(Relighter, EmissionAsBakedChangesNothing) {
  const Stage stage(scene::cornell_box());
  Relighter relighter = relighter_of(stage.data());
  const RelightData& d = relighter.data();
  const Relit baked = relit(relighter, {});
  EXPECT_GT(max_component(baked.indirect[0]), 0);
  // own / mean * mean is rounded three times.
  EXPECT_LT(
      relative_error(relit(relighter, {{}, baked_radiance(d)}).indirect, baked.indirect, d.area_m2),
      1e-6);
}

TEST(Relighter, AnUnevenGlowKeepsItsPattern) {
  RelightData data = Stage(scene::cornell_box()).data();
  for (size_t i = 0; i < data.size(); ++i) data.emission[i] = data.emission[i] * (1 + float(i % 3));
  std::vector<Rgb> wanted = baked_radiance(data);
  for (Rgb& c : wanted) c = c * Rgb{4, 0, 1};
  Relighter relighter = relighter_of(std::move(data));
  const Relit baked = relit(relighter, {}), got = relit(relighter, {{}, wanted});
  for (size_t i = 0; i < baked.indirect.size(); ++i) {
    const Rgb was = baked.indirect[i], is = got.indirect[i];
    EXPECT_NEAR(is.x, 4 * was.x, 1e-5f * was.x) << i;  // sums of 300 floats
    EXPECT_EQ(is.y, 0) << i;
    EXPECT_NEAR(is.z, was.z, 1e-5f * was.z) << i;
  }
}

TEST(Relighter, WhatDidNotGlowCan) {
  // A dark furnace set alight: as if it had been baked glowing.
  const Stage stage(scene::furnace_box({0.5f, 0.25f, 0}, {}));
  Relighter relighter = relighter_of(stage.data());
  for (const Rgb& e : relit(relighter, {}).indirect) EXPECT_EQ(e, Rgb{});
  const std::array radiance{Rgb{1, 2, 3}};
  for (const Rgb& e : relit(relighter, {{}, radiance}).indirect) {
    // Row sums, see above; 1 / (1 - rho) doubles their error at most.
    EXPECT_NEAR(double(e.x), 2 * double(kPi), 4e-3 * double(kPi));
    EXPECT_NEAR(double(e.y), 8 * double(kPi) / 3, 6e-3 * double(kPi));
    EXPECT_NEAR(double(e.z), 3 * double(kPi), 6e-3 * double(kPi));
  }
}

TEST(Relighter, BlackLampsGiveNoLight) {
  Relighter relighter = relighter_of(Stage(scene::cornell_box()).data());
  const std::vector<Rgb> black(relighter.data().material_name.size());
  const scene::PunctualLight off = point_at(kLeft.position, {});
  const Relit got = relit(relighter, {{&off, 1}, black});
  for (size_t i = 0; i < got.direct.size(); ++i) {
    EXPECT_EQ(got.direct[i], Rgb{}) << i;
    EXPECT_EQ(got.indirect[i], Rgb{}) << i;
  }
}

TEST(Relighter, AnOpenPlateReceivesTheWholeSky) {
  // E = pi L: all of the hemisphere is background, and nothing sends any of it back.
  Relighter relighter = relighter_of(Stage(testing::plate()).data());
  for (const Rgb& e : relit(relighter, {{}, {}, {1, 2, 0}}).indirect) {
    EXPECT_NEAR(e.x, kPi, 1e-6f);  // floats
    EXPECT_NEAR(e.y, 2 * kPi, 2e-6f);
    EXPECT_EQ(e.z, 0);
  }
}

TEST(Relighter, TheSkyIsReflectedByWhatSeesIt) {
  const Stage stage(scene::spheres_and_cube());
  Relighter relighter = relighter_of(stage.data());
  const RelightData& d = relighter.data();
  const Answer want = plain_answer(stage, d, {}, {0.5f, 1, 2}, 100);
  const Relit got = relit(relighter, {{}, {}, {0.5f, 1, 2}});
  // Sweeps end at half of max_error, 1e-4, for the light of lamps; the sky is no worse.
  EXPECT_LT(relative_error(got.indirect, want.indirect, d.area_m2), 1e-4);
}

TEST(Relighter, LightOfTwoLampsIsTheSum) {
  for (const CodecKind codec : kAllCodecs) {
    const Stage stage(scene::cornell_box(), small(codec));
    Relighter relighter = relighter_of(stage.data());
    const RelightData& d = relighter.data();
    const std::vector<Rgb> dark(d.material_name.size());
    const std::array both{kLeft, kRight};
    Relit sum = relit(relighter, {{both.data(), 1}, dark});
    const Relit right = relit(relighter, {{both.data() + 1, 1}, dark});
    for (size_t i = 0; i < d.size(); ++i)
      sum.direct[i] += right.direct[i], sum.indirect[i] += right.indirect[i];
    const Relit got = relit(relighter, {both, dark});
    // Sums of 300 floats.
    EXPECT_LT(relative_error(got.direct, sum.direct, d.area_m2), 1e-6) << int(codec);
    EXPECT_LT(relative_error(got.indirect, sum.indirect, d.area_m2), 1e-5) << int(codec);
  }
}

TEST(Relighter, DirectLightAtPlacesIsThatOfLamps) {
  const Stage stage(scene::cornell_box());
  Relighter relighter = relighter_of(stage.data(floor_places(0.54f)), {true});
  const Relit got = relit(relighter, {{&kLeft, 1}});
  const Target& target = relighter.data().target;
  size_t dark = 0;
  for (size_t k = 0; k < target.position.size(); ++k) {
    const Rgb want = plain_light_at(stage, {target.position[k], target.normal[k]}, kLeft);
    EXPECT_LE(length(got.direct_at_place[k] - want), 1e-6f * length(want)) << k;  // floats
    dark += want == Rgb{};
  }
  EXPECT_GT(dark, 4u);  // behind and under the blocks
  EXPECT_LT(dark, 40u);
  Relighter without = relighter_of(stage.data(floor_places(0.54f)));
  EXPECT_TRUE(relit(without, {{&kLeft, 1}}).direct_at_place.empty());
}

TEST(Relighter, SameBitsForAnyNumberOfThreads) {
  for (const CodecKind codec : kAllCodecs) {
    const RelightData data = Stage(scene::cornell_box(), small(codec)).data(floor_places(0.5f));
    const auto with = [&](int threads) {
      const ThreadLimit limit(threads);
      Relighter relighter = relighter_of(data, {true});
      return relit(relighter, {{&kLeft, 1}, {}, {1, 1, 1}});
    };
    const Relit one = with(1);
    for (const int threads : {2, 7}) {
      const Relit other = with(threads);
      EXPECT_EQ(one.direct, other.direct) << int(codec);
      EXPECT_EQ(one.indirect, other.indirect) << int(codec);
      EXPECT_EQ(one.direct_at_place, other.direct_at_place) << int(codec);
      EXPECT_EQ(one.indirect_at_place, other.indirect_at_place) << int(codec);
    }
  }
}

TEST(Relighter, AResultStaysUntilTheNextIsAskedFor) {
  Relighter relighter = relighter_of(Stage(scene::cornell_box()).data());
  EXPECT_EQ(relighter.latest().update, 0u);
  for (const Rgb& e : relighter.latest().indirect) EXPECT_EQ(e, Rgb{});
  relighter.update({{&kLeft, 1}});
  const Relit& held = relighter.latest();
  const Relit copy = held;
  EXPECT_EQ(copy.update, 1u);
  // As many updates as there are results to write to, and more.
  for (int k = 0; k < 5; ++k) {
    relighter.update({{&kRight, 1}});
    EXPECT_EQ(held.update, 1u);
    EXPECT_EQ(held.direct, copy.direct);
    EXPECT_EQ(held.indirect, copy.indirect);
  }
  const Relit& next = relighter.latest();
  EXPECT_EQ(next.update, 6u);
  EXPECT_NE(next.indirect, copy.indirect);
  EXPECT_EQ(&relighter.latest(), &next);  // nothing new since
}

/// Update k is lit by a lamp of 2^(k mod 8) times the first one's intensity. Powers of two scale
/// floats without rounding, so every number of a whole result is scaled exactly.
float scale_of(uint64_t update) { return std::ldexp(1.0f, int(update % 8)); }

bool is_scaled(const Relit& now, const Relit& base) {
  const float scale = scale_of(now.update);
  const auto same = [scale](std::span<const Rgb> a, std::span<const Rgb> b) {
    for (size_t i = 0; i < a.size(); ++i)
      if (!(a[i] == b[i] * scale)) return false;
    return a.size() == b.size();
  };
  return same(now.direct, base.direct) && same(now.indirect, base.indirect) &&
         same(now.indirect_at_place, base.indirect_at_place);
}

TEST(Relighter, OneThreadReadsWhatAnotherUpdates) {
  constexpr uint64_t kUpdates = 400;
  const Stage stage(scene::cornell_box(), small(CodecKind::hierarchical));
  Relighter relighter = relighter_of(stage.data(floor_places(0.5f)));
  const std::vector<Rgb> dark(relighter.data().material_name.size());
  const auto update = [&](uint64_t k) {
    const auto lamp = point_at(kLeft.position, kLeft.intensity * scale_of(k));
    relighter.update({{&lamp, 1}, dark});
  };
  update(1);
  Relit base = relighter.latest();
  for (auto* list : {&base.direct, &base.indirect, &base.indirect_at_place})
    for (Rgb& e : *list) e = e * (1 / scale_of(1));
  std::atomic<bool> reading{false};
  uint64_t last = 0, different = 0, torn = 0, back = 0;
  std::thread reader([&] {
    while (last < kUpdates) {
      const Relit& now = relighter.latest();
      torn += !is_scaled(now, base);
      back += now.update<last, different += now.update> last;
      last = now.update;
      reading = true;
    }
  });
  while (!reading) std::this_thread::yield();
  for (uint64_t k = 2; k <= kUpdates; ++k) update(k);
  reader.join();
  EXPECT_EQ(torn, 0u);
  EXPECT_EQ(back, 0u);
  EXPECT_EQ(last, kUpdates);
  // Both ran at once: more than the first and the last update was seen.
  EXPECT_GT(different, 2u);
}

TEST(MakeRelightData, RefusesWhatCannotBe) {
  Progress progress;
  const scene::Scene empty;
  const auto tracer = trace::RayTracer::build(empty);
  ASSERT_TRUE(tracer);
  EXPECT_FALSE(make_relight_data(empty, *tracer, {}, small(CodecKind::dense32), progress));
  Progress stopped;
  stopped.request_cancel();
  const Stage stage(scene::cornell_box());
  const auto data = make_relight_data(stage.scene, stage.tracer, {}, stage.params, stopped);
  ASSERT_FALSE(data);
  EXPECT_EQ(data.error().code, ErrorCode::cancelled);
}

TEST(MakeRelightData, KeepsToTheErrorThatWasAskedFor) {
  for (const CodecKind codec : {CodecKind::hierarchical, CodecKind::lowrank, CodecKind::dense32}) {
    double before = 1;
    for (const float max_error : {0.03f, 0.003f}) {
      RelightParams params = small(codec, max_error);
      // The hierarchy keeps no more than the noise of the rays lets it know.
      params.patches.count = 150, params.factors.rays_per_patch = 8192;
      const RelightData data = Stage(scene::cornell_box(), params).data();
      EXPECT_LE(data.codec_error, double(max_error)) << int(codec);
      EXPECT_LE(data.codec_error, before) << int(codec);
      before = data.codec_error;
    }
  }
}

}  // namespace
}  // namespace luxel::matrix
