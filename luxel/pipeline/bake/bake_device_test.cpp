// Bakes whose device refuses, or fails midway. The bakes of real devices:
// tests/device_bake_test.cpp.
#include "luxel/pipeline/bake/bake_device.h"

#include <gmock/gmock.h>

#include "luxel/scene/procedural.h"
#include "luxel/solve/gather/rays/ray_device.h"
#include "luxel/solve/gather/rays/traced_hits.h"
#include "luxel/solve/hemicube/hemicube.h"
#include "luxel/solve/hemicube/look_device.h"

namespace luxel::pipeline {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// Fails with an error when it is to trace, or only when it is to sweep.
class FailingDevice final : public gather::RayDevice {
 public:
  explicit FailingDevice(ErrorCode code, bool traces = false) : code_(code), traces_(traces) {}
  Status begin(const gather::TraceScene&) override { return {}; }
  Result<light::LightDevice*> light_device(const gather::TraceScene&) override { return nullptr; }
  Status trace(const gather::TraceScene&, std::span<const uint16_t> target,
               const gather::TraceParams&, gather::TracedHits& hits, Progress& progress) override {
    ++traced;
    if (!traces_) return fail(code_, "the cable is out");
    progress.begin("trace rays", 0);
    for (size_t i = 0; i < hits.size(); ++i)
      hits.samples[i] = hits.counted[i] = hits.escaped[i] = target[i];
    return {};
  }
  Status sweep(const gather::RadiosityMap&, std::span<gather::Gathered>) override {
    return fail(code_, "the cable is out");
  }
  void forget() override { ++forgotten; }

  int traced = 0, forgotten = 0;

 private:
  ErrorCode code_;
  bool traces_;
};

BakeSettings tiny_bake() {
  BakeSettings settings;
  settings.resolution = 16, settings.samples = 16;
  return settings;
}

Result<Bake> bake(const BakeSettings& settings, const BakeDevice* device) {
  Progress progress;
  return bake_read_scene(scene::cornell_box(), settings, progress, {.device = device});
}

TEST(BakeDevice, ThatFailsEndsTheBake) {
  FailingDevice rays(ErrorCode::no_device);
  const BakeDevice device{.rays = &rays, .name = "a card"};
  const auto light = bake(tiny_bake(), &device);
  ASSERT_FALSE(light);
  EXPECT_EQ(light.error().message, "the cable is out");
  EXPECT_EQ(rays.traced, 1);
}

TEST(BakeDevice, ThatIsOptionalLeavesTheBakeToTheProcessor) {
  const auto expected = bake(tiny_bake(), nullptr);
  ASSERT_TRUE(expected);
  // By then the elements' places must still be there.
  for (const auto& [code, traces] :
       {std::pair{ErrorCode::no_device, false}, std::pair{ErrorCode::no_device, true},
        std::pair{ErrorCode::out_of_memory, false}, std::pair{ErrorCode::unsupported, false}}) {
    FailingDevice rays(code, traces);
    const BakeDevice device{.rays = &rays, .name = "a card", .is_optional = true};
    const auto light = bake(tiny_bake(), &device);
    ASSERT_TRUE(light) << light.error().message;
    EXPECT_EQ(rays.traced, 1);
    EXPECT_GE(rays.forgotten, 1);
    EXPECT_EQ(light->light.irradiance, expected->light.irradiance);
    EXPECT_EQ(light->light.device, "");
    EXPECT_THAT(light->warnings,
                Contains("computed on the processor, not on a card: the cable is out"));
  }
}

TEST(BakeDevice, WhoeverStopsABakeStopsItThere) {
  FailingDevice rays(ErrorCode::cancelled);
  const BakeDevice device{.rays = &rays, .name = "a card", .is_optional = true};
  const auto light = bake(tiny_bake(), &device);
  ASSERT_FALSE(light);
  EXPECT_EQ(light.error().code, ErrorCode::cancelled);
}

/// Fails when it is to look through hemicubes.
class FailingLook final : public hemicube::LookDevice {
 public:
  Status begin(const scene::Scene&) override { return {}; }
  Result<hemicube::LookSeconds> look(const hemicube::Senders&, std::span<const hemicube::Viewpoint>,
                                     const hemicube::LookParams&, const hemicube::OnView&,
                                     Progress&) override {
    return fail(ErrorCode::out_of_memory, "the cable is out");
  }
  void forget() override { ++forgotten; }

  int forgotten = 0;
};

TEST(BakeDevice, ThatFailsLeavesHemicubesToTheProcessor) {
  BakeSettings settings;
  settings.resolution = 16, settings.solver = "hemicube";
  auto& params = settings.own.of<hemicube::HemicubeParams>();
  params.resolution = 8, params.max_elements = 200;
  FailingDevice rays(ErrorCode::no_device);
  FailingLook look;
  const BakeDevice needed{.rays = &rays, .look = &look, .name = "a card"};
  const auto refused = bake(settings, &needed);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().message, "the cable is out");
  EXPECT_EQ(look.forgotten, 1);
  const BakeDevice optional{.rays = &rays, .look = &look, .name = "a card", .is_optional = true};
  const auto light = bake(settings, &optional), expected = bake(settings, nullptr);
  ASSERT_TRUE(light && expected);
  EXPECT_EQ(light->light.irradiance, expected->light.irradiance);
  EXPECT_EQ(light->light.device, "");
  EXPECT_THAT(light->warnings, Contains(HasSubstr("not on a card: the cable is out")));
}

TEST(BakeDevice, IsNotAskedForWhatOnlyTheProcessorKnows) {
  BakeSettings matrix = tiny_bake(), keep = tiny_bake(), resume = tiny_bake(), layers = tiny_bake(),
               part = tiny_bake();
  matrix.solver = "matrix", matrix.samples = BakeSettings{}.samples;
  keep.keep = true;
  resume.resume = true;
  layers.layers = light::LayerMode::per_light;
  part.light = LightPart::indirect;
  FailingDevice rays(ErrorCode::no_device);
  const BakeDevice device{.rays = &rays, .name = "a card"};
  const BakeDevice optional{.rays = &rays, .name = "a card", .is_optional = true};
  for (const auto& [settings, option] :
       {std::pair{matrix, "--solver matrix"}, std::pair{keep, "--keep"},
        std::pair{resume, "--resume"}, std::pair{layers, "--layers per-light"},
        std::pair{part, "--light indirect"}}) {
    std::vector<std::string> warnings;
    const auto refused = settle_device(settings, {.device = &device}, warnings);
    ASSERT_FALSE(refused) << option;
    EXPECT_EQ(refused.error().code, ErrorCode::bad_setting);
    EXPECT_THAT(refused.error().message, HasSubstr(option));
    EXPECT_THAT(warnings, IsEmpty());
    const auto settled = settle_device(settings, {.device = &optional}, warnings);
    ASSERT_TRUE(settled);
    EXPECT_EQ(settled->device, nullptr);
    EXPECT_THAT(warnings, ElementsAre(HasSubstr(option)));
  }
}

}  // namespace
}  // namespace luxel::pipeline
