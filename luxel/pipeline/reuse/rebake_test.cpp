#include "luxel/pipeline/reuse/rebake.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>

#include "luxel/base/file.h"
#include "luxel/base/random.h"
#include "luxel/export/baked_glb.h"
#include "luxel/pipeline/bake/bake.h"
#include "luxel/scene/shapes.h"
#include "luxel/solve/gather/gather_test_support.h"

namespace luxel::pipeline {
namespace {

namespace fs = std::filesystem;
using Edit = std::function<void(scene::Scene&)>;
using Scales = std::vector<std::optional<Rgb>>;
using Indices = std::vector<uint32_t>;

constexpr Rgb kOne{1, 1, 1};

/// Materials, instances, lamps and layers of room() by number.
enum : uint32_t { gray, shine, glow };
enum : uint32_t { floor_, panel };
enum : uint32_t { left, right, off };
enum : size_t { left_layer, right_layer, panel_layer, sky_layer };

/// A floor, a panel of two materials that shine, three lamps of which one is off, and a sky.
scene::Scene room() {
  scene::Scene scene;
  scene::add_material(scene, "gray", {0.5f, 0.5f, 0.5f});
  scene::add_material(scene, "shine", {0.1f, 0.1f, 0.1f}, {4, 2, 1});
  scene::add_material(scene, "glow", {0.1f, 0.1f, 0.1f}, {1, 1, 2});
  scene.background = {0.1f, 0.1f, 0.2f};
  scene::add_rectangle(scene, {-1, 1, -1, 1}, 0, true, gray);
  scene::Mesh mesh;
  scene::add_triangle(mesh, {0, 1, 0}, {1, 1, 0}, {0, 1, 1}, shine);
  scene::add_triangle(mesh, {1, 1, 0}, {1, 1, 1}, {0, 1, 1}, glow);
  scene::place(scene, std::move(mesh));
  scene.instances[panel].name = "panel";
  scene.lights.resize(3);
  for (uint32_t k = 0; k < 3; ++k) {
    scene.lights[k].name = "lamp." + std::to_string(k + 1);
    scene.lights[k].position = {float(k) - 1, 2, 0}, scene.lights[k].intensity = {2, 4, 8};
  }
  scene.lights[off].intensity = {};
  return scene;
}

/// A kept bake of the scene, without its light.
KeptBake kept_of(const scene::Scene& scene, light::LayerMode mode) {
  KeptBake kept;
  kept.scene = scene::state_of(scene);
  const light::Lights lights = light::collect_lights(scene);
  if (mode == light::LayerMode::none) return kept;
  const auto layers = light::light_layers(scene, lights, mode);
  EXPECT_TRUE(layers);
  for (const light::LightLayer& layer : layers->layers) kept.layer_names.push_back(layer.name);
  kept.layers = layers_of_lights(scene, lights, *layers);
  return kept;
}

struct Updated {
  LightUpdate update;
  bool is_sum = false;
};
Updated updated(const Edit& edit, light::LayerMode mode = light::LayerMode::per_light) {
  const scene::Scene before = room();
  const KeptBake kept = kept_of(before, mode);
  scene::Scene now = before;
  edit(now);
  const scene::SceneChange change = scene::change_between(kept.scene, scene::state_of(now));
  EXPECT_EQ(change.beyond, "");
  Updated out{light_update(kept, change, now), false};
  out.is_sum = is_sum_of_layers(out.update, change);
  return out;
}

Scales with(size_t layer, std::optional<Rgb> scale, size_t layers = 4) {
  Scales out(layers, kOne);
  out[layer] = scale;
  return out;
}

void expect(const Updated& found, const Scales& scale, const Indices& changed_punctual,
            bool surfaces_changed, bool is_sum) {
  EXPECT_EQ(found.update.scale, scale);
  EXPECT_EQ(found.update.changed_punctual, changed_punctual);
  EXPECT_EQ(found.update.surfaces_changed, surfaces_changed);
  EXPECT_EQ(found.is_sum, is_sum);
}

TEST(LightUpdate, OfNothingIsNone) {
  expect(updated([](scene::Scene&) {}), Scales(4, kOne), {}, false, true);
}

TEST(LightUpdate, ALampIsScaled) {
  expect(updated([](scene::Scene& s) {
           s.lights[left].intensity = {4, 4, 2};
         }),
         with(left_layer, Rgb{2, 1, 0.25f}), {}, false, true);
  expect(updated([](scene::Scene& s) { s.lights[right].intensity = {}; }), with(right_layer, Rgb{}),
         {}, false, true);
}

TEST(LightUpdate, ALampThatShinesOtherwiseIsLookedAt) {
  expect(updated([](scene::Scene& s) { s.lights[right].position.y = 3; }),
         with(right_layer, std::nullopt), {right}, false, false);
}

TEST(LightUpdate, ALampThatWasOffIsLookedAt) {
  expect(updated([](scene::Scene& s) {
           s.lights[off].intensity = {1, 1, 1};
         }),
         Scales(4, kOne), {off}, false, false);
  expect(updated([](scene::Scene& s) { s.lights[off].position.x = 5; }), Scales(4, kOne), {}, false,
         true);
}

// "lamp.1" and "lamp.2" are one layer of groups, before those of the two materials and of the sky.
TEST(LightUpdate, LampsOfALayerAreScaledAlikeOrLookedAt) {
  const auto groups = [](const Edit& edit) { return updated(edit, light::LayerMode::groups); };
  const size_t layers = kept_of(room(), light::LayerMode::groups).layer_names.size();
  expect(groups([](scene::Scene&) {}), Scales(layers, kOne), {}, false, true);
  expect(groups([](scene::Scene& s) {
           for (const uint32_t k : {left, right}) s.lights[k].intensity = {1, 8, 8};
         }),
         with(0, Rgb{0.5f, 2, 1}, layers), {}, false, true);
  const Scales otherwise = with(0, std::nullopt, layers);
  expect(groups([](scene::Scene& s) {
           s.lights[left].intensity = {1, 8, 8}, s.lights[right].intensity = {1, 1, 1};
         }),
         otherwise, {left, right}, false, false);
  for (const uint32_t one : {left, right})
    expect(groups([&](scene::Scene& s) {
             s.lights[one].intensity = {1, 8, 8};
           }),
           otherwise, {left, right}, false, false);
  expect(groups([](scene::Scene& s) { s.lights[right].position.y = 3; }), otherwise, {left, right},
         false, false);
}

TEST(LightUpdate, ASurfaceIsScaledWhereAllOfItIs) {
  expect(updated([](scene::Scene& s) {
           s.materials[shine].emission = {8, 1, 1}, s.materials[glow].emission = {2, 0.5f, 2};
         }),
         with(panel_layer, Rgb{2, 0.5f, 1}), {}, false, true);
  const Scales otherwise = with(panel_layer, std::nullopt);
  expect(updated([](scene::Scene& s) {
           s.materials[shine].emission = {8, 1, 1};
         }),
         otherwise, {}, true, false);
  expect(updated([](scene::Scene& s) {
           s.materials[shine].emission = {8, 4, 2}, s.materials[glow].emission = {3, 3, 6};
         }),
         otherwise, {}, true, false);
}

// By groups the panel's two materials are two layers.
TEST(LightUpdate, AllLayersOfASurfaceAreScaled) {
  const KeptBake kept = kept_of(room(), light::LayerMode::groups);
  const size_t layers = kept.layer_names.size();
  ASSERT_EQ(kept.layers.of_instance[panel].size(), 2u);
  Scales scale(layers, kOne);
  for (const uint8_t layer : kept.layers.of_instance[panel]) scale[layer] = Rgb{2, 2, 2};
  expect(updated(
             [](scene::Scene& s) {
               for (const uint32_t m : {shine, glow}) s.materials[m].emission *= 2;
             },
             light::LayerMode::groups),
         scale, {}, false, true);
}

TEST(LightUpdate, ASurfaceThatDidNotShineIsLookedAt) {
  expect(updated([](scene::Scene& s) {
           s.materials[gray].emission = {1, 1, 1};
         }),
         Scales(4, kOne), {}, true, false);
}

TEST(LightUpdate, AnInstanceThatShinesAndMovesIsLookedAt) {
  const auto move = [](uint32_t instance) {
    return updated([&](scene::Scene& s) {
      s.instances[instance].world_from_object = translation({0, 0.5f, 0});
    });
  };
  expect(move(panel), with(panel_layer, std::nullopt), {}, true, false);
  expect(move(floor_), Scales(4, kOne), {}, false, false);
}

TEST(LightUpdate, OtherSurroundingsAreLookedAt) {
  const Updated found = updated([](scene::Scene& s) { s.background = {0.2f, 0.2f, 0.4f}; });
  EXPECT_TRUE(found.update.surfaces_changed);
  EXPECT_FALSE(found.is_sum);
}

// Light that is not told apart is known as long as all lights are as they were.
TEST(LightUpdate, WithoutLayersLightIsKnownOrNot) {
  const auto alone = [](const Edit& edit) { return updated(edit, light::LayerMode::none); };
  expect(alone([](scene::Scene&) {}), {}, {}, false, true);
  expect(alone([](scene::Scene& s) {
           s.materials[gray].base_color = {0.2f, 0.2f, 0.2f};
         }),
         {}, {}, false, false);
  for (const Edit& edit : {Edit([](scene::Scene& s) {
                             s.lights[left].intensity = {4, 8, 16};
                           }),
                           Edit([](scene::Scene& s) {
                             s.lights[off].intensity = {4, 8, 16};
                           }),
                           Edit([](scene::Scene& s) {
                             s.materials[glow].emission = {2, 2, 4};
                           }),
                           Edit([](scene::Scene& s) {
                             s.background = {1, 1, 1};
                           }),
                           Edit([](scene::Scene& s) {
                             s.instances[floor_].world_from_object = translation({0, 0.1f, 0});
                           })})
    expect(alone(edit), {}, {}, true, false);
}

TEST(LightUpdate, IsNoSumWhereSurfacesReflectOtherwise) {
  expect(updated([](scene::Scene& s) {
           s.materials[gray].base_color = {0.2f, 0.2f, 0.2f};
         }),
         Scales(4, kOne), {}, false, false);
  expect(updated([](scene::Scene& s) {
           s.materials[gray].alpha_mode = scene::AlphaMode::blend, s.materials[gray].alpha = 0.5f;
         }),
         Scales(4, kOne), {}, false, false);
}

/// Light of `n` elements in layers that add up, with some of them dark.
constexpr size_t kLayers = 4;
void fill_light(size_t n, KeptBake& kept) {
  RandomStream random{7};
  const auto some = [&] { return Rgb{random.next(), random.next(), random.next()}; };
  kept.light.layer_irradiance.assign(kLayers, std::vector<Rgb>(n));
  kept.direct.by_layer.resize(n * kLayers);
  for (size_t i = 0; i < n; ++i) {
    Rgb all{}, direct{};
    for (size_t l = 0; l < kLayers && i % 5 != 4; ++l) {
      all += kept.light.layer_irradiance[l][i] = some();
      direct += kept.direct.by_layer[i * kLayers + l] = some();
    }
    kept.light.irradiance.push_back(all), kept.direct.irradiance.push_back(direct);
    kept.light.variance.push_back(random.next()), kept.direct.variance.push_back(random.next());
    kept.direct.split_variance.push_back(random.next());
  }
  kept.light.direct = kept.direct.irradiance, kept.light.direct_variance = kept.direct.variance;
  kept.light.rays = 1000, kept.light.sweeps = 5, kept.light.hidden.assign(n, 0);
  kept.levels = {std::vector<uint8_t>(n), std::vector<uint8_t>(n)};
}

/// The sum in double, of one channel.
double channel_sum(const Scales& scale, int channel, const std::function<Rgb(size_t)>& of_layer) {
  double sum = 0;
  for (size_t l = 0; l < scale.size(); ++l)
    if (scale[l]) sum += double((*scale[l])[channel]) * double(of_layer(l)[channel]);
  return sum;
}

/// Sums of at most 4 floats below 10, each step rounded to 6e-8 of it.
constexpr double kRounding = 4e-6;

void expect_sum(Rgb found, const Scales& scale, const std::function<Rgb(size_t)>& of_layer) {
  for (int channel = 0; channel < 3; ++channel)
    EXPECT_NEAR(found[channel], channel_sum(scale, channel, of_layer), kRounding);
}

/// A standard error is to its value as before.
void expect_as_sure(float variance, Rgb value, float variance_before, Rgb before) {
  if (before == Rgb{}) {
    EXPECT_EQ(variance, variance_before);
    return;
  }
  const double ratio = double(luminance(value)) / double(luminance(before));
  EXPECT_NEAR(variance, variance_before * ratio * ratio, 1e-5);
}

TEST(SumOfLayers, IsTheSumOfEachTimesItsScale) {
  constexpr size_t kElements = 5000;  // more than one of parallel_for's blocks
  KeptBake kept;
  fill_light(kElements, kept);
  const KeptBake before = kept;
  const LightUpdate update{{Rgb{2, 0.5f, 1}, Rgb{}, kOne, Rgb{3, 3, 3}}, {}, false};
  const TexelLight found = sum_of_layers(kept, update);
  ASSERT_EQ(found.irradiance.size(), kElements);
  ASSERT_EQ(found.layer_irradiance.size(), kLayers);
  for (size_t i = 0; i < kElements; ++i) {
    const auto all = [&](size_t l) { return before.light.layer_irradiance[l][i]; };
    const auto direct = [&](size_t l) { return before.direct.by_layer[i * kLayers + l]; };
    expect_sum(found.irradiance[i], update.scale, all);
    expect_sum(found.direct[i], update.scale, direct);
    Rgb sum{};
    for (size_t l = 0; l < kLayers; ++l) {
      EXPECT_EQ(found.layer_irradiance[l][i], all(l) * *update.scale[l]);
      sum += found.layer_irradiance[l][i];
    }
    EXPECT_EQ(sum, found.irradiance[i]);
    expect_as_sure(found.variance[i], found.irradiance[i], before.light.variance[i],
                   before.light.irradiance[i]);
    expect_as_sure(found.direct_variance[i], found.direct[i], before.direct.variance[i],
                   before.direct.irradiance[i]);
  }
  EXPECT_EQ(found.rays, 0u);
  EXPECT_EQ(found.rays_kept, 1000u);
  EXPECT_EQ(found.sweeps, 0);
}

TEST(SumOfLayers, OfLightAsItWasIsThatToTheBit) {
  KeptBake kept;
  fill_light(100, kept);
  for (Rgb& e : kept.light.irradiance) e = e * 1.0001f;  // the layers' sum is not quite the light
  const KeptBake before = kept;
  const TexelLight found = sum_of_layers(kept, {Scales(kLayers, kOne), {}, false});
  EXPECT_EQ(found.irradiance, before.light.irradiance);
  EXPECT_EQ(found.direct, before.light.direct);
  EXPECT_EQ(found.layer_irradiance, before.light.layer_irradiance);
  EXPECT_EQ(found.variance, before.light.variance);
  EXPECT_EQ(found.rays_kept, 1000u);
}

/// A bake of room() with made-up light, and a file of its rays, of which there are none.
class EarlierOf : public ::testing::Test {
 protected:
  void SetUp() override {
    room_ = gather::lay_out(room(), 32);
    kept_ = kept_of(room_->scene, light::LayerMode::per_light);
    const size_t n = room_->elements.size();
    ASSERT_EQ(kept_.layer_names.size(), kLayers);
    fill_light(n, kept_);
    kept_.places = places_of(room_->elements);
    folder_ = fs::temp_directory_path() /
              ("luxel-rebake-" + std::to_string(::getpid()) + "-" +
               ::testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::create_directories(folder_);
    PartStore store({folder_ / "rays", "", "", 1e-9, std::chrono::steady_clock::now()}, progress_);
    gather::keep_samples(&store, 0, std::vector<uint16_t>(n, 16));
  }
  void TearDown() override { fs::remove_all(folder_); }

  /// For an edit that leaves all elements where they are. Uses kept_ up.
  std::optional<gather::Earlier> earlier(const Edit& edit, bool with_layers) {
    edit(room_->scene);
    room_->lights = light::collect_lights(room_->scene);
    change_ = scene::change_between(kept_.scene, scene::state_of(room_->scene));
    update_ = light_update(kept_, change_, room_->scene);
    before_ = kept_;
    rays_.emplace(*RecordFile::open(folder_ / "rays"));
    const auto layers =
        light::light_layers(room_->scene, room_->lights, light::LayerMode::per_light);
    const light::TexelScene in{room_->scene,    room_->atlas,  room_->map,
                               room_->elements, room_->lights, *room_->tracer};
    return earlier_of(kept_, *rays_, update_, change_, in, with_layers ? &*layers : nullptr);
  }
  /// The light that is a first guess, and direct light: of layers by `scale`.
  void expect_light(const gather::Earlier& found, const Scales& all, const Scales& direct) {
    for (size_t i = 0; i < found.irradiance.size(); ++i) {
      expect_sum(found.irradiance[i], all,
                 [&](size_t l) { return before_.light.layer_irradiance[l][i]; });
      expect_sum(found.direct.irradiance[i], direct,
                 [&](size_t l) { return before_.direct.by_layer[i * kLayers + l]; });
    }
  }

  std::unique_ptr<gather::Room> room_;
  KeptBake kept_, before_;
  LightUpdate update_;
  scene::SceneChange change_;
  std::optional<RecordFile> rays_;
  fs::path folder_;
  Progress progress_;
};

void paint(scene::Scene& s) { s.materials[gray].base_color = {0.2f, 0.3f, 0.4f}; }

TEST_F(EarlierOf, WithLayersALampThatIsPutOutLeavesNoDirectLight) {
  const auto found = earlier(
      [](scene::Scene& s) {
        paint(s);
        s.lights[left].intensity = {4, 4, 2}, s.lights[right].intensity = {};
      },
      true);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->rounds, std::vector(1, std::vector<uint16_t>(room_->elements.size(), 16)));
  EXPECT_EQ(std::ranges::count(found->rays.moved, 1), 0);
  EXPECT_TRUE(found->changed_lights.punctual.empty());
  // A lamp that is off has no layer any more: its layers are not those of the kept bake.
  EXPECT_TRUE(found->direct.irradiance.empty());
}

TEST_F(EarlierOf, ScaledDirectLightAddsUp) {
  const auto found = earlier(
      [](scene::Scene& s) {
        paint(s);
        s.lights[left].intensity = {4, 4, 2}, s.lights[right].intensity = {1, 1, 1};
      },
      true);
  ASSERT_TRUE(found);
  const Scales scale{Rgb{2, 1, 0.25f}, Rgb{0.5f, 0.25f, 0.125f}, kOne, kOne};
  EXPECT_EQ(update_.scale, scale);
  expect_light(*found, scale, scale);
  ASSERT_EQ(found->direct.by_layer.size(), before_.direct.by_layer.size());
  for (size_t i = 0; i < found->direct.irradiance.size(); ++i) {
    Rgb sum{};
    for (size_t l = 0; l < kLayers; ++l) sum += found->direct.by_layer[i * kLayers + l];
    EXPECT_EQ(sum, found->direct.irradiance[i]);
    expect_as_sure(found->direct.variance[i], sum, before_.direct.variance[i],
                   before_.direct.irradiance[i]);
    expect_as_sure(found->direct.split_variance[i], sum, before_.direct.split_variance[i],
                   before_.direct.irradiance[i]);
  }
}

// The light of a lamp that moved is taken away, and the lamp is given to be looked at.
TEST_F(EarlierOf, LampsThatShineOtherwiseAreTakenOut) {
  const auto found = earlier(
      [](scene::Scene& s) {
        s.lights[left].position.y = 3, s.lights[off].intensity = {1, 1, 1};
      },
      false);
  ASSERT_TRUE(found);
  Scales direct = with(left_layer, std::nullopt);
  expect_light(*found, Scales(kLayers, kOne), direct);
  EXPECT_TRUE(found->direct.by_layer.empty()) << "nobody tells light apart now";
  ASSERT_EQ(found->changed_lights.punctual.size(), 2u);
  EXPECT_TRUE(found->changed_lights.triangles.empty());
  std::vector<std::string> names;
  for (const auto& lamp : found->changed_lights.punctual) names.push_back(lamp.name);
  std::ranges::sort(names);
  EXPECT_EQ(names, (std::vector<std::string>{"lamp.1", "lamp.3"}));
}

TEST_F(EarlierOf, WithLayersLampsThatShineOtherwiseLeaveNoDirectLight) {
  const auto found = earlier([](scene::Scene& s) { s.lights[left].position.y = 3; }, true);
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->direct.irradiance.empty());
  EXPECT_FALSE(found->irradiance.empty());
}

TEST_F(EarlierOf, SurfacesThatShineOtherwiseLeaveNoDirectLight) {
  const auto found = earlier(
      [](scene::Scene& s) {
        s.materials[shine].emission = {9, 1, 1};
      },
      false);
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->direct.irradiance.empty());
}

TEST_F(EarlierOf, ElementsThatLieElsewhereAreNamed) {
  kept_.places[3] ^= 1, kept_.places[7] ^= 1;
  const auto found = earlier(paint, false);
  ASSERT_TRUE(found);
  for (size_t i = 0; i < found->rays.moved.size(); ++i)
    EXPECT_EQ(found->rays.moved[i], i == 3 || i == 7) << i;
}

// Boxes get a margin, for positions are floats: 1e-4 of the scene's diagonal on all sides.
TEST_F(EarlierOf, BoxesAreGrown) {
  const auto found = earlier(
      [](scene::Scene& s) {
        s.materials[gray].alpha_mode = scene::AlphaMode::blend, s.materials[gray].alpha = 0.5f;
      },
      false);
  ASSERT_TRUE(found);
  ASSERT_EQ(found->rays.boxes.size(), 1u);
  const float margin = 1e-4f * scene::world_bounds(room_->scene).diagonal();
  const Box3 box = found->rays.boxes[0];
  // The rounding of numbers near 1.
  EXPECT_NEAR(box.lower.x, -1 - margin, 2e-7f);
  EXPECT_NEAR(box.lower.y, -margin, 2e-7f);
  EXPECT_NEAR(box.upper.y, margin, 2e-7f);
  EXPECT_NEAR(box.upper.z, 1 + margin, 2e-7f);
}

TEST_F(EarlierOf, ABakeOfOtherTexelsIsRefused) {
  kept_.places.pop_back();
  EXPECT_FALSE(earlier(paint, false));
}

// Layers that are asked for are those of the lights there are now, under the names they have now.
TEST(SlowRebake, HasTheLayersOfABakeFromScratch) {
  const fs::path folder =
      fs::temp_directory_path() / ("luxel-rebake-layers-" + std::to_string(::getpid()));
  fs::create_directories(folder);
  const auto baked = [&](const Edit& edit, const fs::path& output) {
    scene::Scene scene = room();
    edit(scene);
    const auto glb = export_::scene_glb(scene);
    EXPECT_TRUE(glb && write_file_atomically(folder / "room.glb", *glb));
    BakeSettings settings;
    settings.scene = folder / "room.glb", settings.output = output, settings.keep = true;
    settings.resolution = 32, settings.samples = 4, settings.direct_samples = 4;
    settings.layers = light::LayerMode::per_light;
    Progress progress;
    const auto json = bake(settings, progress);
    EXPECT_TRUE(json) << json.error().message;
    std::vector<std::string> names;
    if (json)
      for (const auto& layer : (*json)["layers"]) names.push_back(layer["name"]);
    return names;
  };
  const std::vector<std::string> all = baked([](scene::Scene&) {}, folder / "kept");
  EXPECT_EQ(all.size(), 4u) << "two lamps, the panel and the sky";
  const Edit put_out = [](scene::Scene& s) { s.lights[left].intensity = {}; };
  const Edit rename = [](scene::Scene& s) { s.lights[left].name = "hall"; };
  int number = 0;
  for (const Edit& edit : {put_out, rename}) {
    const auto expected = baked(edit, folder / std::to_string(number++));
    EXPECT_NE(expected, all);
    EXPECT_EQ(baked(edit, folder / "kept"), expected);
  }
  fs::remove_all(folder);
}

}  // namespace
}  // namespace luxel::pipeline
