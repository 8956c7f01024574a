// Light after an edit, held against what must follow and against bakes of the edited scene.
#include "luxel/view/live/estimate.h"

#include <gtest/gtest.h>

#include "luxel/pipeline/bake/bake_scene.h"
#include "luxel/scene/procedural.h"
#include "luxel/solve/matrix/live_light.h"
#include "luxel/view/live/lamp_light.h"
#include "luxel/view/live/spread_texels.h"

namespace luxel::view {
namespace {

/// The light of a bake, to be asked for at places.
Draft as_draft(const scene::Scene& scene, const pipeline::BakeSettings& settings) {
  Progress progress;
  auto bake = pipeline::bake_scene(scene, settings, progress);
  EXPECT_TRUE(bake);
  Draft out;
  out.scene = std::move(bake->scene), out.atlas = std::move(bake->atlas);
  out.map = std::move(bake->map), out.irradiance = std::move(bake->light.irradiance);
  return out;
}

double mean_difference(std::span<const Rgb> a, std::span<const Rgb> b) {
  double off = 0, all = 0;
  for (size_t i = 0; i < a.size(); ++i)
    off += double(std::abs(a[i].y - b[i].y)), all += double(b[i].y);
  return off / all;
}

pipeline::BakeSettings settings_of_estimates() {
  pipeline::BakeSettings out;
  out.output = ::testing::TempDir();
  out.resolution = 128, out.samples = 64;
  return out;
}

/// A bake of a scene, as light is known of it.
std::shared_ptr<KnownLight> known_of(const scene::Scene& scene,
                                     const pipeline::BakeSettings& settings) {
  std::shared_ptr<KnownLight> out;
  pipeline::BakeObserver observer;
  observer.on_estimate = [&](const light::TexelScene& in, const light::LightEstimate& light) {
    if (!light.is_last) return;
    out = *known_light(in, scene);
    out->irradiance.assign(light.irradiance.begin(), light.irradiance.end());
    out->direct.assign(light.direct.begin(), light.direct.end());
  };
  Progress progress;
  EXPECT_TRUE(pipeline::bake_scene(scene, settings, progress, observer));
  return out;
}

/// Light of a bake of the edited scene at the texels of an estimate of it.
std::vector<Rgb> wanted_at(const Draft& estimate, const scene::Scene& edited,
                           const pipeline::BakeSettings& settings) {
  Draft truth = as_draft(edited, settings);
  truth.tracer.emplace(std::move(*trace::RayTracer::build(truth.scene)));
  std::vector<Place> places;
  for (const atlas::Texel& texel : estimate.map.texels)
    places.push_back(
        {scene::world_position(estimate.scene, texel.sample),
         scene::front_normal(estimate.scene, texel.sample.instance, texel.sample.triangle)});
  return light_of_draft(truth, truth.irradiance, places);
}

// Rays meet what they met, so that light is what it was, also at an edit that changes nothing.
TEST(Estimate, LeavesLightAloneThatNothingChanges) {
  const scene::Scene scene = scene::cornell_box();
  const auto known = known_of(scene, settings_of_estimates());
  const Progress nobody;
  const auto estimate = estimate_light(*known, scene, {}, nobody);
  ASSERT_TRUE(estimate);
  ASSERT_EQ((*estimate)->irradiance.size(), known->irradiance.size());
  for (size_t i = 0; i < known->irradiance.size(); ++i)
    EXPECT_LE(length((*estimate)->irradiance[i] - known->irradiance[i]),
              1e-5f * length(known->irradiance[i]));
}

// Light is linear: a lamp of half the strength gives half of all of it, everywhere.
TEST(Estimate, HalvesAllLightOfALampThatIsHalved) {
  const scene::Scene scene = scene::cornell_box();
  scene::Scene dimmed = scene;
  for (scene::Material& m : dimmed.materials) m.emission = m.emission * 0.5f;
  const auto known = known_of(scene, settings_of_estimates());
  const Progress nobody;
  const auto estimate = estimate_light(*known, dimmed, {}, nobody);
  ASSERT_TRUE(estimate);
  std::vector<Rgb> wanted = known->irradiance;
  for (Rgb& e : wanted) e = e * 0.5f;
  EXPECT_LT(mean_difference((*estimate)->irradiance, wanted), 0.01) << "with the old light: 1";
}

// So does a sky.
TEST(Estimate, FollowsTheSky) {
  scene::Scene scene = scene::cornell_box();
  for (scene::Material& m : scene.materials) m.emission = {};
  scene.environment = {8, 4, std::vector<Rgb>(32, Rgb{1, 1, 1}), 0};
  scene::Scene evening = scene;
  for (Rgb& e : evening.environment.radiance) e = e * 0.5f;
  const auto known = known_of(scene, settings_of_estimates());
  const Progress nobody;
  const auto estimate = estimate_light(*known, evening, {}, nobody);
  ASSERT_TRUE(estimate);
  std::vector<Rgb> wanted = known->irradiance;
  for (Rgb& e : wanted) e = e * 0.5f;
  EXPECT_LT(mean_difference((*estimate)->irradiance, wanted), 0.02) << "with the old light: 1";
}

// Metal reflects nothing here: all light is direct.
TEST(Estimate, FollowsMetal) {
  const scene::Scene scene = scene::cornell_box();
  scene::Scene metal = scene;
  for (scene::Material& m : metal.materials) m.metallic = 1;
  const auto known = known_of(scene, settings_of_estimates());
  const Progress nobody;
  const auto estimate = estimate_light(*known, metal, {}, nobody);
  ASSERT_TRUE(estimate);
  EXPECT_LT(mean_difference((*estimate)->irradiance, known->direct), 0.02);
  EXPECT_GT(mean_difference(known->irradiance, known->direct), 0.2);
}

// A bake of the edited scene knows.
TEST(Estimate, IsNearToTheLightOfTheEditedScene) {
  const scene::Scene scene = scene::cornell_box();
  scene::Scene moved = scene;
  Mat34& box = moved.instances.back().world_from_object;
  box = translation({0.05f, 0, 0.05f}) * box;
  const auto known = known_of(scene, settings_of_estimates());
  const Progress nobody;
  const auto estimate = estimate_light(*known, moved, {}, nobody);
  ASSERT_TRUE(estimate);
  const std::vector<Rgb> wanted = wanted_at(**estimate, moved, settings_of_estimates());
  EXPECT_LT(mean_difference((*estimate)->irradiance, wanted), 0.045)
      << "with the old light it would be 0.15, and 0.06 with a draft";
  // Where the edit changes less than 2 %, what was known is better than any draft.
  const auto draft = make_draft(moved, settings_of_estimates(), kQuickDraft, nobody);
  ASSERT_TRUE(draft && *draft);
  std::vector<Place> places;
  for (const atlas::Texel& texel : known->map.texels)
    places.push_back(
        {scene::world_position((*estimate)->scene, texel.sample),
         scene::front_normal((*estimate)->scene, texel.sample.instance, texel.sample.triangle)});
  const std::vector<Rgb> drafted = light_of_draft(**draft, (*draft)->irradiance, places);
  std::vector<Rgb> of[3];  // is estimated, is drafted, is wanted
  for (size_t i = 0; i < wanted.size(); ++i) {
    if (std::abs(known->irradiance[i].y - wanted[i].y) > 0.02f * wanted[i].y) continue;
    of[0].push_back((*estimate)->irradiance[i]), of[1].push_back(drafted[i]);
    of[2].push_back(wanted[i]);
  }
  ASSERT_GT(of[2].size(), wanted.size() / 10);
  EXPECT_LT(mean_difference(of[0], of[2]), 0.5 * mean_difference(of[1], of[2]));
}

/// The Cornell box with a lamp that hangs free in it.
scene::Scene box_with_free_lamp(Vec3 position) {
  scene::Scene out = scene::cornell_box();
  scene::PunctualLight lamp;
  lamp.name = "lamp", lamp.position = position, lamp.intensity = {1, 1, 1};
  out.lights = {lamp};
  return out;
}

// Where there are only lamps, direct light is theirs, with the same samples.
TEST(LampLight, IsAllDirectLightWhereThereIsNoOther) {
  scene::Scene scene = box_with_free_lamp({0.1f, 0.45f, 0.3f});
  for (scene::Material& m : scene.materials) m.emission = {};
  const auto known = known_of(scene, settings_of_estimates());
  Progress progress;
  const pipeline::BakeSettings s = settings_of_estimates();
  ASSERT_TRUE(
      tell_lamps_apart({pipeline::first_direct_samples(s), pipeline::first_supersample(s), s.seed},
                       *known, progress));
  EXPECT_LT(mean_difference(known->of_lamps, known->direct), 1e-6);
  const auto dark = known_of(scene::cornell_box(), settings_of_estimates());
  ASSERT_TRUE(tell_lamps_apart({}, *dark, progress));
  EXPECT_EQ(dark->of_lamps, std::vector<Rgb>(dark->irradiance.size()));
}

// Light without lamps is all light but that of the lamps in their new places.
TEST(Estimate, LeavesOutTheLightOfLamps) {
  const scene::Scene scene = box_with_free_lamp({0.1f, 0.45f, 0.3f}),
                     moved = box_with_free_lamp({0.35f, 0.45f, 0.3f});
  const auto known = known_of(scene, settings_of_estimates());
  Progress progress;
  const pipeline::BakeSettings s = settings_of_estimates();
  ASSERT_TRUE(
      tell_lamps_apart({pipeline::first_direct_samples(s), pipeline::first_supersample(s), s.seed},
                       *known, progress));
  const auto estimate = estimate_light(*known, moved, {}, progress);
  ASSERT_TRUE(estimate);
  const Draft& got = **estimate;
  const std::vector<Rgb> all = wanted_at(got, moved, settings_of_estimates());
  std::vector<Rgb> wanted = all;
  for (size_t i = 0; i < wanted.size(); ++i) {
    const matrix::LitPoints at{
        {&known->position[i], 1}, {&known->normal[i], 1}, {&known->normal[i], 1}};
    wanted[i] = max(wanted[i] - matrix::live_light_at(at, 0, moved.lights, *got.tracer), Rgb{});
  }
  // Nothing but lamps' light is left out: it errs by as much as the whole estimate, but for edges
  // of shadows, which a bake averages within texels.
  double off = 0, without = 0;
  for (size_t i = 0; i < wanted.size(); ++i) {
    off += double(std::abs(got.irradiance[i].y - all[i].y));
    without += double(std::abs(got.without_lamps[i].y - wanted[i].y));
  }
  EXPECT_LT(without, 1.2 * off);
  EXPECT_GT(mean_difference(got.irradiance, wanted), 0.3);
}

// Texels beside each other have nearly the same shares, weights of texels in the middle of what is
// even add up to 1, and what moves stands for nothing else.
TEST(SpreadTexels, AreCloseTogetherWhereSomethingIsEdited) {
  std::vector<Vec3> position, normal;
  std::vector<uint32_t> body;
  for (int y = 0; y < 200; ++y)
    for (int x = 0; x < 200; ++x) {
      position.push_back({0.05f * float(x), 0.013f, 0.05f * float(y)});
      normal.push_back({0, 1, 0}), body.push_back(x < 10 && y < 10 ? 7 : 0);
    }
  const SpreadTexels spread({position, normal, body, 0.0025f},
                            {0.05f, {{{0, 0, 0}, {0.5f, 0.5f, 0.5f}}}}, 2000);
  EXPECT_GT(spread.size(), 200u);
  EXPECT_LE(spread.size(), 3000u);
  EXPECT_GT(spread.level_of(199 * 200 + 199), spread.level_of(20 * 200 + 20));
  for (size_t i = 0; i < position.size(); ++i) {
    std::array<CellShare, kMostShares> shares;
    const size_t count = spread.shares_at(i, shares);
    ASSERT_GE(count, 1u);
    for (size_t k = 0; k < count; ++k) {
      const uint32_t other = spread.texels()[shares[k].cell];
      EXPECT_EQ(body[other], body[i]);
      EXPECT_EQ(spread.level_of(other), spread.level_of(i));
    }
  }
}

}  // namespace
}  // namespace luxel::view
