// A bake that is watched: it hands over what it has, keeps the bits of one that is not, and stops.
#include "luxel/view/live/live_bake.h"

#include <gmock/gmock.h>

#include <chrono>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "luxel/pipeline/bake/bake_scene.h"
#include "luxel/pipeline/reuse/bake_cache.h"
#include "luxel/pipeline/solver/bake_options.h"
#include "luxel/scene/procedural.h"
#include "luxel/view/live/draft.h"
#include "luxel/view/live/fade.h"

namespace luxel::view {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

pipeline::BakeSettings settings_for(const std::string& scene, int resolution, int samples) {
  pipeline::BakeSettings out;
  out.scene = std::string(LUXEL_SOURCE_DIR) + "/scenes/" + scene;
  out.output = ::testing::TempDir();
  out.resolution = resolution, out.samples = samples;
  return out;
}

TEST(LiveBake, EndsWithTheBitsOfABakeThatNobodyWatches) {
  const pipeline::BakeSettings settings = settings_for("cornell-box.glb", 128, 32);
  const auto live = LiveBake::begin(settings);
  live->wait();
  EXPECT_EQ(live->state(), LiveState::baked);
  const LiveNews news = live->take();
  ASSERT_TRUE(news.read && news.lit && news.light && news.before);
  EXPECT_FALSE(news.said);
  EXPECT_TRUE(news.light->is_last);
  Progress progress;
  const auto bake = pipeline::bake_scene(settings, progress);
  ASSERT_TRUE(bake);
  ASSERT_EQ(news.light->pages.size(), bake->lightmaps.size());
  const image::HalfImage wanted = image::to_half(bake->lightmaps[0]);
  EXPECT_EQ(news.light->pages[0].data, wanted.data);
  EXPECT_EQ(news.light->pages[0].scale, wanted.scale);
  EXPECT_EQ(news.light->exposure, bake->view.exposure);
  EXPECT_EQ(news.before->pages[0].width, wanted.width) << "of the bake's layout";
}

TEST(LiveBake, SaysWhyThereIsNoLight) {
  const auto live = LiveBake::begin(settings_for("absent.glb", 64, 4));
  live->wait();
  EXPECT_EQ(live->state(), LiveState::failed);
  EXPECT_THAT(live->take().said.value_or(""), HasSubstr("absent.glb"));
}

// A plate without any light.
TEST(LiveBake, TellsTheWarningsOfTheBake) {
  const std::string file = ::testing::TempDir() + "/live_plate.obj";
  std::ofstream(file) << "v 0 0 0\nv 1 0 0\nv 1 0 -1\nv 0 0 -1\nf 1 2 3 4\n";
  pipeline::BakeSettings settings;
  settings.scene = file, settings.output = ::testing::TempDir();
  settings.resolution = 16, settings.samples = 4;
  const auto live = LiveBake::begin(settings);
  live->wait();
  ASSERT_EQ(live->state(), LiveState::baked) << live->take().said.value_or("");
  EXPECT_THAT(live->take().warnings, Contains(HasSubstr("the scene has no light")));
}

TEST(LiveBake, StandsStillWhilePausedAndEndsWhenNobodyWantsIt) {
  // Some minutes of work.
  const auto live = LiveBake::begin(settings_for("cornell-box.glb", 256, 65535));
  const auto begin = std::chrono::steady_clock::now();
  const auto wait = [](int ms) { std::this_thread::sleep_for(std::chrono::milliseconds(ms)); };
  while (live->snapshot().stage != "trace rays") wait(10);
  live->pause(true);
  EXPECT_EQ(live->state(), LiveState::paused);
  wait(300);  // work looks every 0.2 s
  const uint64_t done = live->snapshot().done;
  wait(300);
  EXPECT_EQ(live->snapshot().done, done);
  live->pause(false);
  EXPECT_EQ(live->state(), LiveState::baking);
  while (live->snapshot().done == done) wait(10);
  live->pause(true);  // and is not waited for when it goes
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(60));
}

/// The scene of cornell-box.glb with its tall box elsewhere.
struct MovedBox {
  SceneNow now;
  scene::Scene scene;
};
MovedBox with_moved_box(const ReadScene& read) {
  const auto as_read = std::make_shared<ReadScene>();
  as_read->scene = read.scene;
  EditDesk desk = begin_editing(as_read);
  const auto box = uint32_t(read.scene.instances.size() - 1);
  EXPECT_EQ(read.scene.instances[box].name, "tall block");
  do_edit(InstanceMoved{box, translation({0.1f, 0, 0.15f}) *
                                 read.scene.instances[box].world_from_object},
          desk);
  return {desk.now, edited(read.scene, desk.now)};
}

/// Takes news until the bake has read its scene.
std::shared_ptr<const ReadScene> wait_for_scene(LiveBake& live) {
  for (;;) {
    if (LiveNews news = live.take(); news.read) return news.read;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
}

TEST(LiveBake, EndsWithTheLightOfTheEditedScene) {
  const pipeline::BakeSettings settings = settings_for("cornell-box.glb", 128, 32);
  const auto live = LiveBake::begin(settings);
  const auto read = wait_for_scene(*live);
  live->wait();
  const float exposure = live->take().light->exposure;
  const MovedBox moved = with_moved_box(*read);
  live->edit(moved.now);
  live->wait();
  ASSERT_EQ(live->state(), LiveState::baked);
  const LiveNews news = live->take();
  ASSERT_TRUE(news.read && news.lit && news.light);
  EXPECT_TRUE(news.light->is_last);
  EXPECT_EQ(news.light->exposure, exposure) << "it stays";
  Progress progress;
  const auto bake = pipeline::bake_scene(moved.scene, settings, progress);
  ASSERT_TRUE(bake) << bake.error().message;
  EXPECT_EQ(news.light->pages[0].data, image::to_half(bake->lightmaps[0]).data);
}

/// The lightmap of a scene that is baked with --keep, after the one of settings.scene was.
image::HalfImage baked_after(const scene::Scene& scene, const pipeline::BakeSettings& settings) {
  Progress progress;
  {
    pipeline::BakeCache cache(settings, pipeline::settings_of_kept_bake(settings));
    EXPECT_TRUE(pipeline::bake_scene(settings, progress, {nullptr, &cache}));
    cache.finish(progress);
  }
  pipeline::BakeCache cache(settings, pipeline::settings_of_kept_bake(settings));
  const auto bake = pipeline::bake_read_scene(scene, settings, progress, {nullptr, &cache});
  return bake ? image::to_half(bake->lightmaps[0]) : image::HalfImage{};
}

// The tests of Rebake hold such a bake against one from scratch.
TEST(LiveBake, BuildsOnAKeptBakeAfterAnEdit) {
  pipeline::BakeSettings settings = settings_for("cornell-box.glb", 64, 32);
  settings.keep = true;
  settings.output = std::filesystem::path(::testing::TempDir()) / "live_kept";
  std::filesystem::remove_all(settings.output);
  const auto live = LiveBake::begin(settings);
  const auto read = wait_for_scene(*live);
  live->wait();
  (void)live->take();
  const MovedBox moved = with_moved_box(*read);
  live->edit(moved.now);
  live->wait();
  ASSERT_EQ(live->state(), LiveState::baked) << live->take().said.value_or("");
  EXPECT_THAT(live->notes(), Contains(HasSubstr("instance 'tall block' moved")));
  settings.output = std::filesystem::path(::testing::TempDir()) / "baked_kept";
  std::filesystem::remove_all(settings.output);
  EXPECT_EQ(live->take().light->pages[0].data, baked_after(moved.scene, settings).data);
}

TEST(LiveBake, HasADraftOfAnEditThoughTheBakeGoesOnForMinutes) {
  const auto live = LiveBake::begin(settings_for("cornell-box.glb", 256, 65535));
  const auto read = wait_for_scene(*live);
  const MovedBox moved = with_moved_box(*read);
  while (live->snapshot().stage != "trace rays")
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  (void)live->take();
  for (int again = 0; again < 5; ++again) {
    live->edit(again % 2 ? unedited(read->scene) : moved.now);
    LiveNews news;
    while (!news.read) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      news = live->take();
    }
    ASSERT_TRUE(news.light);
    EXPECT_EQ(news.light->numbers.kind, LiveKind::estimate);
    EXPECT_TRUE(news.light->is_sudden);
    EXPECT_EQ(news.read->scene.instances.back().world_from_object,
              (again % 2 ? read->scene : moved.scene).instances.back().world_from_object);
  }
}

// Some minutes of work, which nobody waits for: wait() returns since the bake has ended.
TEST(LiveBake, RestsWithADraftUntilTheNextEditAfterIt) {
  const auto live = LiveBake::begin(settings_for("cornell-box.glb", 256, 65535));
  live->rest(true);  // before anything is read
  const auto read = wait_for_scene(*live);
  live->wait();
  EXPECT_EQ(live->state(), LiveState::paused);
  const LiveNews first = live->take();
  ASSERT_TRUE(first.light && !first.said);
  EXPECT_EQ(first.light->numbers.kind, LiveKind::draft);
  const MovedBox moved = with_moved_box(*read);
  live->edit(moved.now);
  live->wait();
  EXPECT_EQ(live->state(), LiveState::paused);
  EXPECT_TRUE(live->take().light) << "of the edited scene";
  live->rest(false);
  live->edit(moved.now);
  while (live->snapshot().stage != "trace rays")
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  EXPECT_EQ(live->state(), LiveState::baking);
  live->rest(true);
  live->wait();
  EXPECT_EQ(live->state(), LiveState::paused);
  EXPECT_FALSE(live->take().said) << "it is no failure";
}

// In a furnace all surfaces get pi e / (1 - rho), wherever they are asked.
TEST(Draft, HasTheLightOfAFurnaceInAnotherLayout) {
  const float rho = 0.5f;
  const scene::Scene scene = scene::furnace_box({rho, rho, rho}, {1, 1, 1});
  pipeline::BakeSettings settings;
  settings.output = ::testing::TempDir();
  settings.resolution = 128;
  const Progress nobody;
  const auto draft = make_draft(scene, settings, kFirstDraft, nobody);
  ASSERT_TRUE(draft && *draft);
  settings.samples = 1, settings.direct_samples = 1;
  Progress progress;
  pipeline::BakeObserver observer;
  std::vector<Rgb> elsewhere;
  observer.on_estimate = [&](const light::TexelScene& in, const light::LightEstimate&) {
    if (elsewhere.empty()) elsewhere = light_of_draft(**draft, (*draft)->irradiance, in);
  };
  ASSERT_TRUE(pipeline::bake_scene(scene, settings, progress, observer));
  ASSERT_GT(elsewhere.size(), 1000u);
  const float wanted = kPi / (1 - rho);
  double off = 0;
  for (const Rgb& e : elsewhere)
    off += std::abs(double(e.x / wanted) - 1) / double(elsewhere.size());
  EXPECT_LT(off, 0.03) << "32 rays, half of whose light is direct";
}

// Coarse texels and few rays are off by 4 % of the light; one value everywhere would be by 53 %.
TEST(Draft, HasLightWhereABakeHasIt) {
  const scene::Scene scene = scene::cornell_box();
  pipeline::BakeSettings settings;
  settings.output = ::testing::TempDir();
  settings.resolution = 128, settings.samples = 64;
  const Progress nobody;
  const auto draft = make_draft(scene, settings, kFirstDraft, nobody);
  ASSERT_TRUE(draft && *draft);
  Progress progress;
  pipeline::BakeObserver observer;
  double off = 0, all = 0;
  observer.on_estimate = [&](const light::TexelScene& in, const light::LightEstimate& light) {
    if (!light.is_last) return;
    const std::vector<Rgb> drafted = light_of_draft(**draft, (*draft)->irradiance, in);
    for (size_t i = 0; i < drafted.size(); ++i)
      off += double(std::abs(drafted[i].y - light.irradiance[i].y)),
          all += double(light.irradiance[i].y);
  };
  ASSERT_TRUE(pipeline::bake_scene(scene, settings, progress, observer));
  EXPECT_LT(off / all, 0.08);
}

TEST(Draft, IsNotMadeWhereTheBakeIsNoFiner) {
  pipeline::BakeSettings settings;
  settings.resolution = 64;
  const Progress nobody;
  const auto draft =
      make_draft(scene::furnace_box({0.5f, 0.5f, 0.5f}, {1, 1, 1}), settings, kFirstDraft, nobody);
  ASSERT_TRUE(draft);
  EXPECT_EQ(*draft, nullptr);
}

TEST(Fade, GoesFromOnePictureToTheOtherAndBack) {
  Fade fade;
  EXPECT_TRUE(is_free(fade));
  EXPECT_EQ(second_light(fade), 0);
  fade.exposure_newest = 4;
  fade = faded_to_other(fade, 1);
  EXPECT_FALSE(is_free(fade));
  EXPECT_EQ(second_light(fade), 0);
  EXPECT_EQ(exposure(fade), 4);
  pass(kFade_s / 2, fade);
  EXPECT_NEAR(second_light(fade), 0.5, 1e-6);
  EXPECT_NEAR(exposure(fade), 2, 1e-6) << "a stop of two";
  pass(kFade_s, fade);
  EXPECT_EQ(second_light(fade), 1);
  EXPECT_EQ(exposure(fade), 1);
  fade = faded_to_other(fade, 1);
  pass(kFade_s / 4, fade);
  EXPECT_NEAR(second_light(fade), 0.75, 1e-6);
}

}  // namespace
}  // namespace luxel::view
