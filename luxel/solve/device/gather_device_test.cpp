// Bakes whose rays are a device's are those of the processor. Skipped without a device.
#include "luxel/solve/device/gather_device.h"

#include <gmock/gmock.h>

#include <optional>

#include "luxel/base/differences.h"
#include "luxel/gpu/device_test_support.h"
#include "luxel/light/light_device.h"
#include "luxel/scene/light_kinds.h"
#include "luxel/scene/procedural.h"
#include "luxel/scene/shapes.h"
#include "luxel/solve/gather/bounce/sweep.h"
#include "luxel/solve/gather/gather_test_support.h"
#include "tests/scratch_folder.h"

namespace luxel::device {
namespace {

/// Hands on to another, and counts the places that it lights.
class CountingLight final : public light::LightDevice {
 public:
  explicit CountingLight(light::LightDevice& inner) : inner_(&inner) {}

  Result<uint64_t> light_at(std::span<const light::Receiver> receivers,
                            const light::LightAsked& asked, std::span<light::LightAt> out,
                            Progress& progress) override {
    lit += receivers.size();
    return inner_->light_at(receivers, asked, out, progress);
  }

  size_t lit = 0;

 private:
  light::LightDevice* inner_;
};

/// Hands on to another, and counts.
class Counting final : public gather::RayDevice {
 public:
  explicit Counting(const gpu::Device& device) : inner_(gather_device(device)) {}

  Status begin(const gather::TraceScene& in) override { return inner_->begin(in); }
  Result<light::LightDevice*> light_device(const gather::TraceScene& in) override {
    LUXEL_TRY(light::LightDevice * inner, inner_->light_device(in));
    return inner ? &light.emplace(*inner) : nullptr;
  }
  Status trace(const gather::TraceScene& in, std::span<const uint16_t> target,
               const gather::TraceParams& params, gather::TracedHits& hits,
               Progress& progress) override {
    ++traced;
    return inner_->trace(in, target, params, hits, progress);
  }
  Status sweep(const gather::RadiosityMap& map, std::span<gather::Gathered> out) override {
    ++swept;
    return inner_->sweep(map, out);
  }
  void forget() override {
    ++forgotten;
    inner_->forget();
  }

  std::optional<CountingLight> light;
  int traced = 0, swept = 0, forgotten = 0;

 private:
  std::unique_ptr<gather::RayDevice> inner_;
};

class BakesOnDevice : public gpu::testing::OnDevice {
 protected:
  /// gather() with all rays on the device.
  gather::Gather solve(const gather::Room& room, const gather::GatherParams& params) {
    Counting rays(*device_);
    gather::Gather out = gather::solve(room, params, {.device = &rays});
    lit_ = rays.light ? rays.light->lit : 0;
    EXPECT_GE(lit_, out.samples.size());
    traced_ = rays.traced;
    EXPECT_GE(traced_, 1);
    EXPECT_GE(rays.swept, out.sweeps);
    EXPECT_GE(rays.forgotten, 1);
    return out;
  }

  // By the last solve():
  size_t lit_ = 0;  ///< places
  int traced_ = 0;  ///< rounds
};

std::vector<float> luminances(std::span<const Rgb> light) {
  std::vector<float> out;
  for (const Rgb& l : light) out.push_back(luminance(l));
  return out;
}

// All bounces. The difference is that of rays that graze an edge, and of bounces that end a sweep
// sooner or later: 0.2 % and, of all light, 0.02 %.
TEST_F(BakesOnDevice, AreThoseOfTheProcessor) {
  for (scene::Scene& scene :
       std::vector<scene::Scene>{scene::cornell_box(), scene::closed_corner()}) {
    const auto room = gather::lay_out(std::move(scene), 64);
    const gather::GatherParams params = gather::with_samples(128, 16);
    const gather::Gather expected = gather::solve(*room, params), found = solve(*room, params);
    const Differences d =
        differences(luminances(found.irradiance), luminances(expected.irradiance));
    EXPECT_LT(d.rms, 2e-3);
    EXPECT_LT(std::abs(d.bias), 2e-4);
    EXPECT_EQ(found.enclosed, expected.enclosed);
    EXPECT_EQ(found.samples, expected.samples);
  }
}

/// A block on a floor, in a sun with a disc and under a lamp: shadows with and without soft edges.
scene::Scene block_in_the_sun() {
  scene::Scene scene;
  const uint32_t gray = scene::add_material(scene, "gray", {0.5f, 0.5f, 0.5f}, {});
  const uint32_t lamp = scene::add_material(scene, "lamp", {}, Rgb{20, 20, 20});
  scene::add_rectangle(scene, {-4, 4, -4, 4}, 0, true, gray);
  scene::add_rectangle(scene, {-1, 0, -1, 0}, 3, false, lamp);
  scene::Mesh block;
  scene::add_box(block, {0, 0, 0}, {1, 1, 1}, gray);
  scene::place(scene, std::move(block));
  scene::PunctualLight sun;
  sun.kind = scene::LightKind::directional, sun.direction = normalize(Vec3{1, -2, 0.5f});
  sun.angular_radius_rad = 0.01f;
  scene.lights = {sun};
  return scene;
}

// Texels are averaged over points where a shadow's edge crosses them, and more finely where light
// is not known well: all of it on the device. A texel whose unevenness rounding decides otherwise
// differs by its noise.
TEST_F(BakesOnDevice, AverageTexelsOverPoints) {
  const auto room = gather::lay_out(block_in_the_sun(), 64);
  gather::GatherParams params = gather::with_samples(64, 16);
  params.supersample = 16, params.more_points = params.more_shadow_rays = true;
  const gather::Gather expected = gather::solve(*room, params), found = solve(*room, params);
  ASSERT_GT(expected.supersampled, 20u);
  EXPECT_NEAR(double(found.supersampled), double(expected.supersampled),
              0.02 * double(expected.supersampled));
  EXPECT_GT(lit_, found.samples.size() + 16 * found.supersampled);
  const Differences d = differences(luminances(found.direct), luminances(expected.direct));
  EXPECT_LT(d.rms, 2e-3);
  EXPECT_LT(std::abs(d.bias), 2e-4);
}

// A reflection counted, or none: rays are not followed on then.
TEST_F(BakesOnDevice, HaveAsManyBouncesAsAreAskedFor) {
  const auto room = gather::lay_out(scene::cornell_box(), 32);
  for (const int bounces : {0, 1}) {
    gather::GatherParams params = gather::with_samples(64, 16);
    params.bounces = bounces;
    const gather::Gather expected = gather::solve(*room, params), found = solve(*room, params);
    const Differences d =
        differences(luminances(found.irradiance), luminances(expected.irradiance));
    EXPECT_LT(d.rms, 2e-3);
    EXPECT_LT(std::abs(d.bias), 2e-4);
  }
}

TEST_F(BakesOnDevice, RefuseColouredGlass) {
  scene::Scene scene = scene::cornell_box();
  scene.materials[0].transmission = 1, scene.materials[0].base_color = {0.5f, 1, 1};
  const auto room = gather::lay_out(std::move(scene), 32);
  const auto rays = gather_device(*device_);
  Progress progress;
  const auto light = gather::gather(gather::scene_of(*room), nullptr, gather::with_samples(16),
                                    {.device = rays.get()}, {}, progress);
  ASSERT_FALSE(light);
  EXPECT_EQ(light.error().code, ErrorCode::unsupported);
  EXPECT_THAT(light.error().message, ::testing::HasSubstr("coloured glass"));
}

// Rounds of more rays, some of which follow a guide and begin anew: as many samples each, if each
// round knows what all before it have found. Where rounding moves an element over the threshold of
// a round, it has other rays: its noise is 2 % of its light.
TEST_F(BakesOnDevice, HaveTheRoundsOfTheProcessor) {
  const auto room = gather::lay_out(scene::cornell_box(), 48);
  for (const auto measure : {gather::ErrorMeasure::rms, gather::ErrorMeasure::p95}) {
    gather::GatherParams params = gather::with_samples(64, 64);
    params.max_error = measure == gather::ErrorMeasure::rms ? 0.004f : 0.04f;
    params.error_measure = measure;
    const gather::Gather expected = gather::solve(*room, params), found = solve(*room, params);
    EXPECT_GT(traced_, 1);
    EXPECT_GT(*std::ranges::max_element(found.samples), 64);
    size_t others = 0;
    for (size_t i = 0; i < found.samples.size(); ++i)
      others += found.samples[i] != expected.samples[i];
    EXPECT_LT(double(others), 0.01 * double(found.samples.size()));
    const Differences d =
        differences(luminances(found.irradiance), luminances(expected.irradiance));
    EXPECT_LT(d.rms, 2e-3);
    EXPECT_LT(std::abs(d.bias), 2e-4);
    EXPECT_NEAR(double(found.rays), double(expected.rays), 1e-2 * double(expected.rays));
    EXPECT_NEAR(found.relative_error, expected.relative_error, 0.02 * expected.relative_error);
  }
}

/// Has rays and light, and fails when it is to sweep.
class LostLater final : public gather::RayDevice {
 public:
  explicit LostLater(const gpu::Device& device) : inner_(gather_device(device)) {}

  Status begin(const gather::TraceScene& in) override { return inner_->begin(in); }
  Result<light::LightDevice*> light_device(const gather::TraceScene& in) override {
    return inner_->light_device(in);
  }
  Status trace(const gather::TraceScene& in, std::span<const uint16_t> target,
               const gather::TraceParams& params, gather::TracedHits& hits,
               Progress& progress) override {
    return inner_->trace(in, target, params, hits, progress);
  }
  Status sweep(const gather::RadiosityMap&, std::span<gather::Gathered>) override {
    return fail(ErrorCode::no_device, "the cable is out");
  }
  void forget() override { inner_->forget(); }

 private:
  std::unique_ptr<gather::RayDevice> inner_;
};

// The processor traces no ray and lights no place again that the device has kept: it goes on with
// the sweeps.
TEST_F(BakesOnDevice, GoOnWhereTheDeviceWasLost) {
  const auto room = gather::lay_out(block_in_the_sun(), 48);
  gather::GatherParams params = gather::with_samples(100, 16);
  params.supersample = 16;
  const gather::Gather expected = solve(*room, params);
  const testing_support::ScratchFolder folder;
  Progress progress;
  PartStoreParams kept;
  kept.file = folder.path / "parts", kept.header = "test", kept.interval_s = 1e-9;
  PartStore parts(kept, progress);
  LostLater lost(*device_);
  const auto failed = gather::gather(gather::scene_of(*room), nullptr, params,
                                     {.parts = &parts, .device = &lost}, {}, progress);
  ASSERT_FALSE(failed);
  EXPECT_EQ(failed.error().message, "the cable is out");
  const uint64_t made = parts.parts_kept();
  EXPECT_GT(made, 2 * (room->elements.size() / gather::kTileElements));
  const auto found =
      gather::gather(gather::scene_of(*room), nullptr, params, {.parts = &parts}, {}, progress);
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(parts.parts_found(), made) << "all of them";
  EXPECT_EQ(parts.parts_kept(), made) << "and none had to be made";
  EXPECT_EQ(found->direct, expected.direct);
  const Differences d = differences(luminances(found->irradiance), luminances(expected.irradiance));
  EXPECT_LT(d.rms, 1e-4) << "sums in another order";
}

}  // namespace
}  // namespace luxel::device
