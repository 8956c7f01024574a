#include "luxel/solve/matrix/relighter.h"

#include <gtest/gtest.h>

#include "luxel/solve/matrix/lxr.h"
#include "luxel/solve/matrix/lxr_test_support.h"
#include "luxel/solve/matrix/matrix.h"
#include "luxel/solve/matrix/relighter_test_support.h"

namespace luxel::matrix {
namespace {

using testing::floor_places;
using testing::kAllCodecs;
using testing::kLeft;
using testing::kRight;
using testing::point_at;
using testing::relative_error;
using testing::relighter_of;
using testing::relit;
using testing::small;
using testing::Stage;

/// I cos / d^2 at a place, unless a ray to the lamp meets something before it.
Rgb plain_light_at(const Stage& stage, const PatchPoint& at, const scene::PunctualLight& lamp) {
  const Vec3 to = lamp.position - at.position;
  const float along = dot(at.normal, to), d2 = dot(to, to);
  if (along <= 0) return {};
  if (stage.tracer.closest_hit({at.position, 0, to, INFINITY}).t < 0.999f) return {};
  return lamp.intensity * (along / (d2 * std::sqrt(d2)));
}

/// Light without codecs: plain products until nothing is left to come.
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
  std::vector<Rgb> sent, straight;
  const std::vector<Rgb> glowing = mean_emission_of(d);
  for (size_t i = 0; i < d.size(); ++i) {
    Rgb direct{};
    for (uint32_t k = d.first_probe[i]; k < d.first_probe[i + 1]; ++k)
      for (const auto& lamp : lamps) direct += plain_light_at(stage, d.probe[k], lamp);
    direct = direct / float(d.first_probe[i + 1] - d.first_probe[i]);
    straight.push_back(background * (kPi * prepared->sky[i]));
    for (uint32_t k = d.glow.first[i]; k < d.glow.first[i + 1]; ++k)
      straight[i] += d.glow.irradiance[k] * glowing[d.glow.material[k]];
    out.direct.push_back(direct);
    sent.push_back(d.reflectance[i] * (direct + straight[i]));
  }
  out.indirect.resize(d.size());
  for (int k = 0; k < products; ++k) {
    std::vector<Rgb> radiosity = sent;
    for (size_t i = 0; i < d.size(); ++i) radiosity[i] += d.reflectance[i] * out.indirect[i];
    out.indirect = testing::plain_product(prepared->factors, radiosity);
  }
  for (size_t i = 0; i < d.size(); ++i) out.indirect[i] += straight[i];
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
    EXPECT_LT(relative_error(got.indirect, want.indirect, d.area_m2), d.codec_error) << int(codec);
    EXPECT_GT(d.codec_error, 0) << int(codec);
    EXPECT_LT(d.usual_codec_error, 0.03) << int(codec);
  }
}

// The file has no place for a distribution: what it would show instead would be wrong.
TEST(RelightData, RefusesLampsWithProfiles) {
  Stage stage(scene::cornell_box(scene::CornellColors::pbrt, true));
  stage.scene.lights = {kLeft};
  stage.scene.lights[0].name = "left";
  scene::attach_profile(stage.scene, 0, {"a", {}, {0, 1}, {0}, {5, 4}}, 1);
  Progress progress;
  const auto data = make_relight_data(stage.scene, stage.tracer, {}, stage.params, progress);
  ASSERT_FALSE(data);
  EXPECT_NE(data.error().message.find("light 'left' has a light profile"), std::string::npos);
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
    ASSERT_EQ(got.indirect_at_points.size(), 64u);
    for (const auto* list : {&got.indirect, &got.indirect_at_points}) {
      const std::vector<Rgb> even(list->size(), want);
      const std::vector<float> one(list->size(), 1.0f);
      // The light of lamps may err by 1 %, root mean square; light from everywhere errs less.
      EXPECT_LT(relative_error(*list, even, one), 0.01) << int(codec);
      // Rows sum to 1 within 1e-3 (see Reciprocal.KeepsRowSums), which 1 / (1 - rho) doubles; 0.6
      // of max_error more may be missing after the sweeps.
      for (const Rgb& e : *list)
        for (int c = 0; c < 3 && codec == CodecKind::dense32; ++c)
          EXPECT_NEAR(e[c], want[c], 8e-3f * want[c]);
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

// As a file of version 1.0 has it: light of glowing surfaces passes through the codec.
TEST(Relighter, AnUnevenGlowKeepsItsPattern) {
  RelightData data = Stage(scene::cornell_box()).data();
  data.glow = {};
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
  // Sweeps end at 0.6 of max_error, 1e-4, for the light of lamps; the sky is no worse.
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

// Light of lamps that stay is kept from update to update: what it was before must leave no trace.
TEST(Relighter, FollowsWhicheverLampChanges) {
  const Stage stage(scene::cornell_box());
  std::vector<scene::PunctualLight> lamps;  // more than are kept
  for (int k = 0; k < 18; ++k)
    lamps.push_back(point_at({0.05f + 0.02f * float(k), 0.4f, 0.2f}, {1, 0.5f, 0.1f * float(k)}));
  Relighter relighter = relighter_of(stage.data());
  relit(relighter, {lamps});
  for (const size_t changed : {size_t(0), size_t(3), size_t(17)}) {
    lamps[changed].position.y -= 0.1f;
    lamps[changed].intensity = lamps[changed].intensity * 2.0f;
    Relighter fresh = relighter_of(stage.data());
    EXPECT_EQ(relit(relighter, {lamps}).direct, relit(fresh, {lamps}).direct) << changed;
  }
  lamps.resize(2);
  Relighter fresh = relighter_of(stage.data());
  EXPECT_EQ(relit(relighter, {lamps}).direct, relit(fresh, {lamps}).direct);
}

// Direct light given at the probes takes the place of the lamp that makes it.
TEST(Relighter, TakesDirectLightOfProbes) {
  const Stage stage(scene::cornell_box());
  Relighter relighter = relighter_of(stage.data());
  const RelightData& d = relighter.data();
  std::vector<Rgb> at_probes;
  for (const PatchPoint& probe : d.probe) at_probes.push_back(plain_light_at(stage, probe, kLeft));
  const Relit got = relit(relighter, {.direct_at_probes = at_probes});
  const Relit want = relit(relighter, {{&kLeft, 1}});
  EXPECT_LT(relative_error(got.indirect, want.indirect, d.area_m2), 1e-6);  // floats
  EXPECT_GT(luminance(got.indirect[0]), 0);
}

TEST(Relighter, DirectLightAtPlacesIsThatOfLamps) {
  const Stage stage(scene::cornell_box());
  Relighter relighter = relighter_of(stage.data(floor_places(0.54f)), {true});
  const Relit got = relit(relighter, {{&kLeft, 1}});
  const Target& target = relighter.data().target;
  size_t dark = 0;
  for (size_t k = 0; k < target.position.size(); ++k) {
    const Rgb want = plain_light_at(stage, {target.position[k], target.normal[k]}, kLeft);
    EXPECT_LE(length(got.direct_at_points[k] - want), 1e-6f * length(want)) << k;  // floats
    dark += want == Rgb{};
  }
  EXPECT_GT(dark, 4u);  // behind and under the blocks
  EXPECT_LT(dark, 40u);
  Relighter without = relighter_of(stage.data(floor_places(0.54f)));
  EXPECT_TRUE(relit(without, {{&kLeft, 1}}).direct_at_points.empty());
}

// Files before 1.2 have their places on the floor itself, from where rays would meet it.
TEST(Relighter, LightsThePlacesOfFilesBefore12) {
  const Stage stage(scene::cornell_box());
  const RelightData now = stage.data(floor_places(0.54f));
  RelightData then = now;
  for (Vec3& p : then.target.position) p.y = 0;
  for (PatchPoint& p : then.probe)
    p.position += p.normal * -scene::rounding_m(p.position, 0.125f * 0.55f);
  auto read = decode_lxr(testing::of_earlier(encode_lxr(then), 1, {"ORIG"}), "then.lxr");
  ASSERT_TRUE(read) << read.error().message;
  Relighter before = relighter_of(std::move(*read), {true}), after = relighter_of(now, {true});
  const Relit got = relit(before, {{&kLeft, 1}}), want = relit(after, {{&kLeft, 1}});
  for (size_t k = 0; k < want.direct_at_points.size(); ++k)  // 2^-18 m at 0.2 m from the lamp
    EXPECT_LE(length(got.direct_at_points[k] - want.direct_at_points[k]),
              1e-4f * length(want.direct_at_points[k]))
        << k;
  // Some probes see it at a low angle.
  for (size_t k = 0; k < want.direct.size(); ++k)
    EXPECT_LE(length(got.direct[k] - want.direct[k]), 1e-3f * length(want.direct[k])) << k;
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
      // So few rays leave factors with noise of some ten percent, which the hierarchy must keep.
      params.patches.count = 150, params.factors.rays_per_patch = 512;
      const RelightData data = Stage(scene::cornell_box(), params).data();
      EXPECT_LE(data.usual_codec_error, double(max_error)) << int(codec);
      EXPECT_LE(data.usual_codec_error, before) << int(codec);
      EXPECT_GE(data.codec_error, data.usual_codec_error) << int(codec);
      before = data.usual_codec_error;
    }
  }
}

}  // namespace
}  // namespace luxel::matrix
