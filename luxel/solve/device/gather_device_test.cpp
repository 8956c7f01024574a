// Bakes whose first rays are a device's are those of the processor. Skipped without a device.
#include "luxel/solve/device/gather_device.h"

#include <gmock/gmock.h>

#include "luxel/base/differences.h"
#include "luxel/gpu/device_test_support.h"
#include "luxel/scene/procedural.h"
#include "luxel/solve/gather/bounce/sweep.h"
#include "luxel/solve/gather/gather_test_support.h"

namespace luxel::device {
namespace {

/// Hands on to another, and counts.
class Counting final : public gather::RayDevice {
 public:
  explicit Counting(const gpu::Device& device) : inner_(gather_device(device)) {}

  Status begin(const gather::TraceScene& in) override { return inner_->begin(in); }
  bool knows_lights(const gather::TraceScene& in) const override {
    return inner_->knows_lights(in);
  }
  Result<light::DirectLight> direct_light(const gather::TraceScene& in,
                                          const light::DirectParams& params,
                                          Progress& progress) override {
    ++lit;
    return inner_->direct_light(in, params, progress);
  }
  Status trace(const gather::TraceScene& in, int samples, const gather::TraceParams& params,
               gather::TracedHits& hits, Progress& progress) override {
    ++traced;
    return inner_->trace(in, samples, params, hits, progress);
  }
  Status sweep(const gather::RadiosityMap& map, std::span<gather::Gathered> out) override {
    ++swept;
    return inner_->sweep(map, out);
  }
  void forget() override {
    ++forgotten;
    inner_->forget();
  }

  int lit = 0, traced = 0, swept = 0, forgotten = 0;

 private:
  std::unique_ptr<gather::RayDevice> inner_;
};

class BakesOnDevice : public gpu::testing::OnDevice {
 protected:
  /// gather() with the first rays on the device.
  gather::Gather solve(const gather::Room& room, const gather::GatherParams& params) {
    Counting rays(*device_);
    gather::Gather out = gather::solve(room, params, {.device = &rays});
    EXPECT_EQ(rays.lit, 1);
    EXPECT_EQ(rays.traced, 1);
    EXPECT_GE(rays.swept, out.sweeps);
    EXPECT_GE(rays.forgotten, 1);
    return out;
  }
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

// Rounds of more rays, which the processor traces, go on from the device's first one. Two bakes
// with an error of 1 % each differ by 1.4 %; a round that were lost or counted twice would make it
// 10 %.
TEST_F(BakesOnDevice, GoOnWithRoundsOfTheProcessor) {
  const auto room = gather::lay_out(scene::cornell_box(), 48);
  gather::GatherParams params = gather::with_samples(64, 64);
  params.max_error = 0.01f, params.error_measure = gather::ErrorMeasure::rms;
  const gather::Gather expected = gather::solve(*room, params), found = solve(*room, params);
  ASSERT_GT(found.samples[0], 64);
  const Differences d = differences(luminances(found.irradiance), luminances(expected.irradiance));
  EXPECT_LT(d.rms, 0.02);
  EXPECT_LT(std::abs(d.bias), 0.005);
}

}  // namespace
}  // namespace luxel::device
