// Rays that a device makes, traces and keeps bring what the processor's bring. Skipped without a
// device.
#include "luxel/solve/device/landed_rays.h"

#include <gmock/gmock.h>

#include <optional>

#include "luxel/base/differences.h"
#include "luxel/base/random.h"
#include "luxel/gpu/device_test_support.h"
#include "luxel/light/device/direct_light_on_device.h"
#include "luxel/scene/procedural.h"
#include "luxel/scene/shapes.h"
#include "luxel/scene/sides.h"
#include "luxel/solve/device/device_sweep.h"
#include "luxel/solve/gather/bounce/sweep.h"
#include "luxel/solve/gather/gather_test_support.h"

namespace luxel::device {
namespace {

/// The light that the rays of a scene bring from a map, on the device or on the processor.
struct Brought {
  std::vector<Rgb> irradiance;
  std::vector<float> variance, split_variance;
};

/// A map whose texels all differ.
gather::RadiosityMap any_map(const gather::Room& room, const gather::TracedHits& hits) {
  RandomStream random{3};
  std::vector<Rgb> irradiance(room.elements.size());
  for (Rgb& e : irradiance) e = {random.next(), random.next(), random.next()};
  gather::RadiosityMap out = gather::empty_radiosity_map(room.map.resolution);
  gather::fill_radiosity(out, room.map, room.elements, hits, {}, irradiance);
  return out;
}

Brought swept(const gather::RadiosityMap& map, const gather::TracedHits& hits) {
  const size_t n = hits.size();
  const std::vector<Rgb> none(n);
  Brought out{std::vector<Rgb>(n), std::vector<float>(n), std::vector<float>(n)};
  Progress progress;
  gather::Sweep sweep{.direct = none,
                      .irradiance = out.irradiance,
                      .variance = out.variance,
                      .split_variance = out.split_variance};
  EXPECT_TRUE(gather::run_sweep(map, hits, sweep, progress));
  return out;
}

uint64_t sum_of_differences(std::span<const uint16_t> a, std::span<const uint16_t> b) {
  uint64_t out = 0;
  for (size_t i = 0; i < a.size(); ++i) out += uint64_t(std::abs(int(a[i]) - int(b[i])));
  return out;
}

class LandedRaysOnDevice : public gpu::testing::OnDevice {
 protected:
  /// So many rays of each element of `room` on the device and on the processor bring the same.
  /// Those that the processor ends have their paths on the device, if that has double precision.
  void expect_the_same(const gather::Room& room, trace::HierarchyKind kind, int samples,
                       const LandParams& land = {});
};

// The two differ by rounding, and by rays that graze an edge: one that ends elsewhere in one of
// these scenes, of 3e5 rays, changes a texel by 1/64, which is 2e-4 of the mean, root mean square.
constexpr double kMostRms = 5e-4, kMostBias = 1e-5, kMostElsewhere = 1e-5;

void LandedRaysOnDevice::expect_the_same(const gather::Room& room, trace::HierarchyKind kind,
                                         int samples, const LandParams& land) {
  const transport::OwnSides sides =
      transport::find_own_sides(room.scene, room.atlas, room.map, *room.tracer);
  const gather::TraceScene in = gather::trace_scene(gather::scene_of(room), &sides);
  const gather::TraceParams params{.seed = 5, .follows_near = true};
  Progress progress;
  const auto expected = gather::trace_hits(in, samples, params, progress);
  ASSERT_TRUE(expected);
  const size_t n = room.elements.size();
  auto tracer = trace::DeviceRayTracer::build(*device_, room.scene, kind);
  ASSERT_TRUE(tracer);
  gather::TracedHits found = gather::no_hits(n);
  LandedSeconds seconds;
  std::optional<light::DeviceDirectLight> light;
  if (device_->has_doubles) {
    auto made = light::DeviceDirectLight::make(*tracer, *commands_, room.scene, room.lights);
    ASSERT_TRUE(made) << made.error().message;
    light.emplace(std::move(*made));
  }
  const DeviceScene scene{*tracer, *commands_, in, light ? &*light : nullptr};
  auto landed = begin_rays(scene, params);
  ASSERT_TRUE(landed) << landed.error().message;
  const Status status = land_round(scene, std::vector<uint16_t>(n, uint16_t(samples)), land, params,
                                   *landed, found, seconds, progress);
  ASSERT_TRUE(status) << status.error().message;

  const gather::RadiosityMap map = any_map(room, *expected);
  const Brought by_processor = swept(map, *expected);
  std::vector<on_device::Gathered> gathered(n);
  ASSERT_TRUE(sweep(*commands_, *landed, map, gathered));
  const auto per_sample = 1 / float(samples);
  std::vector<float> e, e2, halves, expected_e, expected_e2, expected_halves;
  for (size_t i = 0; i < n; ++i) {
    const Rgb sky = found.sky[i] * kPi;
    e.push_back(luminance(gathered[i].sum + sky) * per_sample);
    // Rays that bring light with the map and without it count twice; a variance is never below 0.
    e2.push_back(
        std::max((gathered[i].sum_luminance2 + kPi * kPi * found.sky_luminance2[i]) * per_sample,
                 e.back() * e.back()));
    halves.push_back(
        std::abs(gathered[i].first_less_second + kPi * found.sky_first_less_second[i]) *
        per_sample);
    expected_e.push_back(luminance(by_processor.irradiance[i]));
    // Rays are taken as independent: var = (e2 - e^2) / n.
    expected_e2.push_back(by_processor.variance[i] / per_sample +
                          expected_e.back() * expected_e.back());
    // Halves have the same size: var = (difference / n)^2.
    expected_halves.push_back(std::sqrt(by_processor.split_variance[i]));
  }
  const auto of_light = differences(e, expected_e), of_squares = differences(e2, expected_e2),
             of_halves = differences(halves, expected_halves);
  EXPECT_LT(of_light.rms, kMostRms);
  EXPECT_LT(std::abs(of_light.bias), kMostBias);
  EXPECT_LT(of_squares.rms, 2 * kMostRms);
  EXPECT_LT(of_halves.rms, 20 * kMostRms) << "a small difference of large sums";
  const auto rays = double(n) * double(samples);
  EXPECT_LT(double(sum_of_differences(found.escaped, expected->escaped)), kMostElsewhere * rays);
  EXPECT_LT(double(sum_of_differences(found.met_back, expected->met_back)), kMostElsewhere * rays);
  EXPECT_LT(
      double(sum_of_differences(found.met_double_sided_back, expected->met_double_sided_back)),
      kMostElsewhere * rays);
  EXPECT_EQ(found.samples, expected->samples);
  EXPECT_EQ(found.counted, expected->counted);
  EXPECT_NEAR(double(found.rays), double(expected->rays), 1e-3 * double(expected->rays));
}

/// Blocks on a floor under a sky that has a dark and a bright half.
scene::Scene blocks_under_a_sky() {
  scene::Scene scene;
  scene.background = {0.1f, 0.2f, 0.3f};
  scene.environment.width = 8, scene.environment.height = 4;
  for (int k = 0; k < 32; ++k)
    scene.environment.radiance.push_back(k % 8 < 4 ? Rgb{0.2f, 0.1f, 0.1f} : Rgb{1, 0.8f, 0.5f});
  scene.environment.radiance[5] = {50, 50, 50};  // a sun, which is aimed at
  scene.environment.rotation_rad = 0.7f;
  const uint32_t gray = scene::add_material(scene, "gray", {0.5f, 0.4f, 0.3f}, {});
  scene::add_rectangle(scene, {-2, 2, -2, 2}, 0, true, gray);
  scene::Mesh block;
  scene::add_box(block, {-0.5f, 0, -0.5f}, {0.5f, 0.7f, 0.5f}, gray);
  scene::place(scene, std::move(block));
  return scene;
}

/// A floor under a wide double-sided leaf whose back it sees, and the back of a one-sided square.
/// `has_both_sides`: the leaf's back has texels of its own.
scene::Scene leaf_over_a_floor(bool has_both_sides) {
  scene::Scene scene;
  scene.background = {1, 1, 1};
  const uint32_t gray = scene::add_material(scene, "gray", {0.8f, 0.8f, 0.8f}, {});
  const uint32_t leaf = scene::add_material(scene, "leaf", {0.6f, 0.7f, 0.2f}, {});
  scene.materials[leaf].double_sided = true;
  scene::add_rectangle(scene, {-1, 1, -1, 1}, 0, true, gray);
  scene::add_rectangle(scene, {-2, 2, -2, 2}, 0.5f, true, leaf);
  scene::add_rectangle(scene, {-0.1f, 0.1f, -0.1f, 0.1f}, 0.3f, true, gray);
  if (has_both_sides) scene::add_backs(scene, scene.instances[1].mesh, std::vector<uint8_t>{1, 1});
  return scene;
}

/// Walls without thickness on a floor whose texels lie on both sides of them.
scene::Scene walls_on_a_floor() {
  scene::Scene scene;
  scene.background = {1, 1, 1};
  const uint32_t gray = scene::add_material(scene, "gray", {0.5f, 0.5f, 0.5f}, {});
  scene::add_rectangle(scene, {-2, 2, -2, 2}, 0, true, gray);
  scene::Mesh walls;
  for (const float x : {-0.83f, 0.11f, 0.97f})
    scene::add_box(walls, {x, 0, -1.3f}, {x + 0.02f, 1, 1.3f}, gray);
  scene::place(scene, std::move(walls));
  return scene;
}

// In corners and beside walls most rays end on the processor; under a leaf more than there is room
// for at first. Samples are a multiple of the number of cells, and none.
TEST_F(LandedRaysOnDevice, BringWhatTheProcessorsBring) {
  const auto binary = trace::HierarchyKind::binary, wide = trace::HierarchyKind::wide;
  const auto cornell = gather::lay_out(scene::cornell_box(), 64);
  expect_the_same(*cornell, binary, 64);
  expect_the_same(*cornell, wide, 64, {.rays_of_chunk = 64 * 64 * 5});
  expect_the_same(*gather::lay_out(blocks_under_a_sky(), 64), wide, 100);
  expect_the_same(*gather::lay_out(leaf_over_a_floor(false), 64), wide, 64, {.open_share = 100});
  expect_the_same(*gather::lay_out(leaf_over_a_floor(true), 64), binary, 64);
  expect_the_same(*gather::lay_out(walls_on_a_floor(), 64), binary, 100);
}

TEST_F(LandedRaysOnDevice, BringTheSameByRayQueries) {
  if (!device_->has_ray_queries) GTEST_SKIP() << device_->name << " has no ray queries";
  const auto driver = trace::HierarchyKind::driver;
  expect_the_same(*gather::lay_out(scene::cornell_box(), 64), driver, 64);
  expect_the_same(*gather::lay_out(leaf_over_a_floor(true), 64), driver, 64);
}

// Rays land in the same places each time, whatever order the device works in.
TEST_F(LandedRaysOnDevice, BringTheSameBitsEachTime) {
  const auto room = gather::lay_out(leaf_over_a_floor(false), 48);
  const transport::OwnSides sides =
      transport::find_own_sides(room->scene, room->atlas, room->map, *room->tracer);
  const gather::TraceScene in = gather::trace_scene(gather::scene_of(*room), &sides);
  auto tracer = trace::DeviceRayTracer::build(*device_, room->scene);
  ASSERT_TRUE(tracer);
  std::vector<std::vector<on_device::Gathered>> gathered;
  for (int k = 0; k < 2; ++k) {
    Progress progress;
    gather::TracedHits hits = gather::no_hits(room->elements.size());
    LandedSeconds seconds;
    const gather::TraceParams params{.seed = 1, .follows_near = true};
    auto landed = begin_rays({*tracer, *commands_, in}, params);
    ASSERT_TRUE(landed);
    const std::vector<uint16_t> target(hits.size(), 64);
    ASSERT_TRUE(land_round({*tracer, *commands_, in}, target, {}, params, *landed, hits, seconds,
                           progress));
    gathered.emplace_back(room->elements.size());
    ASSERT_TRUE(sweep(*commands_, *landed, any_map(*room, hits), gathered.back()));
  }
  for (size_t i = 0; i < gathered[0].size(); ++i) {
    ASSERT_EQ(gathered[0][i].sum, gathered[1][i].sum);
    ASSERT_EQ(gathered[0][i].sum_luminance2, gathered[1][i].sum_luminance2);
    ASSERT_EQ(gathered[0][i].first_less_second, gathered[1][i].first_less_second);
  }
}

}  // namespace
}  // namespace luxel::device
