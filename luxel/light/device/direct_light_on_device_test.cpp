// A device's direct light is that of the processor. Skipped without a device.
#include "luxel/light/device/direct_light_on_device.h"

#include <gmock/gmock.h>

#include "luxel/base/differences.h"
#include "luxel/base/random.h"
#include "luxel/gpu/device_test_support.h"
#include "luxel/light/direct_light.h"
#include "luxel/light/shadow_rays.h"
#include "luxel/scene/light_kinds.h"
#include "luxel/scene/procedural.h"
#include "luxel/scene/shapes.h"
#include "luxel/scene/surface_points.h"

namespace luxel::light {
namespace {

/// Places all over the surfaces of a scene.
transport::Elements places_of(const scene::Scene& scene, size_t count) {
  transport::Elements out;
  for (const scene::SurfacePoint& p : scene::points_uniform_in_area(scene, count, 3)) {
    const transport::SmoothPoint s = transport::smooth_point(scene, p);
    out.position.push_back(s.start), out.normal.push_back(s.normal);
    out.geometric_normal.push_back(s.geometric_normal);
    out.reflectance.push_back({0.5f, 0.5f, 0.5f});
  }
  return out;
}

double sum_of(std::span<const float> values) {
  double out = 0;
  for (const float v : values) out += double(v);
  return out;
}

class DirectLightOnDevice : public gpu::testing::OnDevice {
 protected:
  void SetUp() override {
    OnDevice::SetUp();
    if (device_ && !device_->has_doubles) GTEST_SKIP() << "the device has no double precision";
  }
  /// The light of both is the same, and so is what they say of its noise.
  void expect_the_same(const scene::Scene& scene, int samples, trace::HierarchyKind kind);
};

// Shadow rays that graze an edge, and draws that rounding decides otherwise, change an element by
// the light of one of its rays: one of 1000 elements differs by about 1/20 of its light then.
constexpr double kMostRms = 2e-3, kMostBias = 2e-4;

void DirectLightOnDevice::expect_the_same(const scene::Scene& scene, int samples,
                                          trace::HierarchyKind kind) {
  const transport::Elements elements = places_of(scene, 4000);
  const Lights lights = collect_lights(scene);
  const auto on_processor = trace::RayTracer::build(scene);
  const auto on_device = trace::DeviceRayTracer::build(*device_, scene, kind);
  ASSERT_TRUE(on_processor && on_device);
  const DirectParams params{.samples = samples, .seed = 5};
  Progress progress;
  const auto expected = direct_light(scene, elements, lights, *on_processor, params, progress);
  ASSERT_TRUE(device_knows(scene, lights));
  auto device = DeviceDirectLight::make(*on_device, *commands_, scene, lights);
  ASSERT_TRUE(device) << device.error().message;
  const auto found =
      direct_light({scene, elements, lights, *on_processor, &*device}, params, progress);
  ASSERT_TRUE(found) << found.error().message;
  std::vector<float> light, expected_light;
  for (const Rgb& e : found->irradiance) light.push_back(luminance(e));
  for (const Rgb& e : expected->irradiance) expected_light.push_back(luminance(e));
  const Differences d = differences(light, expected_light);
  EXPECT_LT(d.rms, kMostRms);
  EXPECT_LT(std::abs(d.bias), kMostBias);
  // Noise of a thousandth of the mean light is rounding.
  const double sum = sum_of(expected_light);
  const double no_noise = 1e-6 * sum * sum / double(elements.size());
  const double variance = sum_of(expected->variance), split = sum_of(expected->split_variance);
  EXPECT_NEAR(sum_of(found->variance), variance, 5e-3 * variance + no_noise);
  EXPECT_NEAR(sum_of(found->split_variance), split, 2e-2 * split + no_noise);
  EXPECT_NEAR(double(found->rays), double(expected->rays), 1e-3 * double(expected->rays));
}

/// Blocks on a floor, under nothing.
scene::Scene blocks() {
  scene::Scene scene;
  const uint32_t gray = scene::add_material(scene, "gray", {0.5f, 0.5f, 0.5f}, {});
  scene::add_rectangle(scene, {-4, 4, -4, 4}, 0, true, gray);
  for (const float x : {-2.0f, 0.5f, 1.7f}) {
    scene::Mesh block;
    scene::add_box(block, {x, 0, -x}, {x + 0.6f, 0.8f, 0.7f - x}, gray);
    scene::place(scene, std::move(block));
  }
  return scene;
}

/// A sun with a disc, a sun without, a spot, and a lamp with a range.
scene::Scene blocks_under_punctual_lights() {
  scene::Scene scene = blocks();
  scene::PunctualLight sun, far, spot, lamp;
  sun.kind = far.kind = scene::LightKind::directional;
  sun.direction = normalize(Vec3{1, -2, 0.5f}), sun.angular_radius_rad = 0.05f;
  far.direction = normalize(Vec3{-1, -1, -1}), far.intensity = {0.2f, 0.3f, 0.4f};
  spot.kind = scene::LightKind::spot, spot.position = {1, 3, 1}, spot.intensity = {9, 8, 7};
  spot.inner_cone_rad = 0.3f, spot.outer_cone_rad = 0.6f;
  lamp.position = {-1.5f, 1.5f, 0}, lamp.range_m = 4;
  scene.lights = {sun, far, spot, lamp};
  return scene;
}

/// Hundreds of lamps of both kinds, whose light is drawn.
scene::Scene blocks_under_many_lamps(bool punctual) {
  scene::Scene scene = blocks();
  RandomStream random{2};
  for (int k = 0; k < 300; ++k) {
    const float x = 8 * random.next() - 4, z = 8 * random.next() - 4, y = 1.5f + random.next();
    if (punctual) {
      scene::PunctualLight lamp;
      lamp.position = {x, y, z}, lamp.intensity = Rgb{1, 1, 1} * (0.1f + random.next());
      scene.lights.push_back(lamp);
      continue;
    }
    const float l = 1 + 10 * random.next();
    const uint32_t material = scene::add_material(scene, "lamp", {}, Rgb{l, l, 2 * l});
    scene.materials[material].double_sided = k % 3 == 0;
    scene::add_rectangle(scene, {x, x + 0.1f, z, z + 0.1f}, y, false, material);
  }
  return scene;
}

scene::Scene blocks_under_a_bright_sky() {
  scene::Scene scene = blocks();
  scene.environment.width = 16, scene.environment.height = 8;
  for (int k = 0; k < 128; ++k)
    scene.environment.radiance.push_back(Rgb{0.2f, 0.1f, 0.1f} * (1 + float(k % 5)));
  scene.environment.radiance[20] = {90, 80, 70}, scene.environment.radiance[36] = {30, 20, 10};
  scene.environment.rotation_rad = 0.7f;
  return scene;
}

TEST_F(DirectLightOnDevice, IsThatOfTheProcessor) {
  const auto binary = trace::HierarchyKind::binary, wide = trace::HierarchyKind::wide;
  expect_the_same(scene::cornell_box(), 64, binary);
  expect_the_same(scene::cornell_box(), 1, wide);
  expect_the_same(blocks_under_punctual_lights(), 32, wide);
  expect_the_same(blocks_under_many_lamps(false), 64, wide);
  expect_the_same(blocks_under_many_lamps(true), 64, wide);
  expect_the_same(blocks_under_a_bright_sky(), 64, binary);
}

/// A leaf with holes lets light through by chance; glass and masks alike.
scene::Scene blocks_under_a_leaf() {
  scene::Scene scene = blocks_under_punctual_lights();
  const uint32_t leaf = scene::add_material(scene, "leaf", {0.5f, 0.5f, 0.5f}, {});
  scene::Texture texture;
  texture.width = texture.height = 8;
  for (int k = 0; k < 64; ++k)
    for (const int c : {255, 255, 255, (k + k / 8) % 2 == 0 ? 255 : 0})
      texture.rgba.push_back(uint8_t(c));
  scene.textures.push_back(std::move(texture));
  scene.materials[leaf].alpha_mode = scene::AlphaMode::mask;
  scene.materials[leaf].base_color_texture.texture = 0;
  scene.materials[leaf].base_color_texture.filter = scene::Filter::nearest;
  scene::add_rectangle(scene, {-3, 3, -3, 3}, 1, true, leaf);
  scene::Mesh& mesh = scene.meshes[scene.instances.back().mesh];
  for (const Vec3& p : mesh.positions) mesh.uv0.push_back({p.x, p.z});
  return scene;
}

TEST_F(DirectLightOnDevice, PassesHoles) {
  expect_the_same(blocks_under_a_leaf(), 32, trace::HierarchyKind::wide);
}

TEST_F(DirectLightOnDevice, IsThatOfTheProcessorByRayQueries) {
  if (!device_->has_ray_queries) GTEST_SKIP() << device_->name << " has no ray queries";
  expect_the_same(scene::cornell_box(), 64, trace::HierarchyKind::driver);
  expect_the_same(blocks_under_a_leaf(), 32, trace::HierarchyKind::driver);
}

/// Blocks under a lamp with a coloured picture, which is cut into pieces; mirrored, or not.
scene::Scene blocks_under_a_picture(bool mirrored) {
  scene::Scene scene = blocks();
  const uint32_t lamp = scene::add_material(scene, "lamp", {}, Rgb{9, 8, 7});
  scene::Texture texture;
  texture.width = 8, texture.height = 16;
  for (int k = 0; k < 128; ++k)
    for (const int c : {k % 8 * 30, k * 2, 255 - k, 255}) texture.rgba.push_back(uint8_t(c));
  scene.textures.push_back(std::move(texture));
  scene.materials[lamp].emission_texture.texture = 0;
  scene.materials[lamp].emission_texture.wrap_u = scene::Wrap::mirror;
  scene::add_rectangle(scene, {-1, 1, -1.5f, 0.5f}, 2, mirrored, lamp);
  scene::Mesh& mesh = scene.meshes[scene.instances.back().mesh];
  for (const Vec3& p : mesh.positions) mesh.uv0.push_back({0.7f * p.x, 0.4f * p.z});
  if (mirrored) scene.instances.back().world_from_object = scaling({1, -1, 1});
  if (mirrored)
    for (Vec3& p : mesh.positions) p.y = -p.y;
  return scene;
}

// By the pieces of two triangles; and by the two triangles of a picture that hardly varies.
TEST_F(DirectLightOnDevice, IsThatOfPictures) {
  for (const bool mirrored : {false, true}) {
    scene::Scene scene = blocks_under_a_picture(mirrored);
    const Lights lights = collect_lights(scene);
    EXPECT_GT(lights.triangles.size(), 32u);
    expect_the_same(scene, 64, trace::HierarchyKind::wide);
  }
  scene::Scene scene = blocks_under_a_picture(false);
  for (uint8_t& byte : scene.textures[0].rgba) byte = uint8_t(240 + byte / 32);
  EXPECT_LE(collect_lights(scene).triangles.size(), 32u);
  expect_the_same(scene, 64, trace::HierarchyKind::binary);
}

// Lamps measured about each axis, turned, and one that is even all round.
TEST_F(DirectLightOnDevice, IsThatOfLampsWithProfiles) {
  scene::Scene scene = blocks();
  for (const auto angles : {scene::LightProfile::Angles::a, scene::LightProfile::Angles::b,
                            scene::LightProfile::Angles::c, scene::LightProfile::Angles::c}) {
    const size_t k = scene.lights.size();
    scene::LightProfile profile;
    profile.angles = angles;
    const bool is_even = k == 3, is_around = angles == scene::LightProfile::Angles::c;
    profile.vertical_rad = {is_around ? 0 : -1.2f, 0.3f, 0.7f, 1.3f};
    profile.horizontal_rad = is_even     ? std::vector<float>{0}
                             : is_around ? std::vector<float>{0, 1, 4, 2 * kPi}
                                         : std::vector<float>{-0.9f, 0.1f, 0.8f};
    RandomStream random{k};
    for (size_t n = 0; n < 4 * profile.horizontal_rad.size(); ++n)
      profile.candela.push_back(1 + 9 * random.next());
    scene::PunctualLight lamp;
    lamp.position = {float(k) - 1.5f, 2, 0.5f * float(k) - 1};
    lamp.direction = normalize(Vec3{0.3f * float(k) - 0.4f, -1, 0.2f});
    lamp.side = {1, 0.2f, 0.1f * float(k)};
    scene.lights.push_back(lamp);
    scene::attach_profile(scene, k, std::move(profile), 1 + 0.1f * float(k));
  }
  expect_the_same(scene, 16, trace::HierarchyKind::wide);
}

// E = I / h^2 straight below a lamp in the ceiling.
TEST_F(DirectLightOnDevice, IsThatOfALampInASurface) {
  scene::Scene scene;
  const uint32_t gray = scene::add_material(scene, "gray", {0.5f, 0.5f, 0.5f}, {});
  scene::add_rectangle(scene, {-5, 5, -5, 5}, 0, true, gray);
  scene::add_rectangle(scene, {-5, 5, -5, 5}, 3, false, gray);
  transport::Elements below;
  below.position = {{0, 1e-6f, 0}}, below.normal = below.geometric_normal = {{0, 1, 0}};
  below.reflectance = {{0.5f, 0.5f, 0.5f}};
  for (const float above : {0.0f, 1e-5f}) {
    scene::PunctualLight lamp;
    lamp.position = {0, 3 + above, 0}, lamp.intensity = {900, 900, 900};
    scene.lights = {lamp};
    const Lights lights = collect_lights(scene);
    const auto on_processor = trace::RayTracer::build(scene);
    const auto on_device = trace::DeviceRayTracer::build(*device_, scene);
    ASSERT_TRUE(on_processor && on_device);
    auto device = DeviceDirectLight::make(*on_device, *commands_, scene, lights);
    ASSERT_TRUE(device);
    Progress progress;
    const auto found =
        direct_light({scene, below, lights, *on_processor, &*device}, {.samples = 1}, progress);
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->irradiance[0].x, 100, 1e-2f) << above;
  }
}

// A picture with holes sends light through some of itself alone: it is the processor's.
TEST_F(DirectLightOnDevice, IsNotWorkedOutOfLightsThatTheDeviceDoesNotKnow) {
  scene::Scene scene = blocks_under_a_picture(false);
  EXPECT_TRUE(device_knows(scene, collect_lights(scene)));
  scene.materials.back().alpha_mode = scene::AlphaMode::mask;
  EXPECT_FALSE(device_knows(scene, collect_lights(scene)));
}

// Only those that are asked for change.
TEST_F(DirectLightOnDevice, IsThatOfSomeElements) {
  const scene::Scene scene = scene::cornell_box();
  const transport::Elements elements = places_of(scene, 200);
  const Lights lights = collect_lights(scene);
  const auto on_processor = trace::RayTracer::build(scene);
  const auto tracer = trace::DeviceRayTracer::build(*device_, scene);
  ASSERT_TRUE(tracer && on_processor);
  auto device = DeviceDirectLight::make(*tracer, *commands_, scene, lights);
  ASSERT_TRUE(device);
  const LitElements lit{scene, elements, lights, *on_processor, &*device};
  const DirectParams params{.samples = 16};
  Progress progress;
  auto all = direct_light(lit, params, progress);
  ASSERT_TRUE(all);
  DirectLight some = *all;
  const std::vector<uint32_t> which{3, 17, 150};
  ASSERT_TRUE(direct_light_again(lit, which, {.samples = 256}, some, progress));
  for (size_t i = 0; i < elements.size(); ++i) {
    if (std::ranges::find(which, uint32_t(i)) != which.end()) continue;
    EXPECT_EQ(some.irradiance[i], all->irradiance[i]);
  }
  DirectLight again = *all;
  ASSERT_TRUE(direct_light_again(lit, which, params, again, progress));
  EXPECT_EQ(again.irradiance, all->irradiance) << "the same seed, the same rays";
  progress.request_cancel();
  EXPECT_FALSE(direct_light_again(lit, which, params, again, progress));
}

std::vector<float> luminances(std::span<const LightAt> light) {
  std::vector<float> out;
  for (const LightAt& l : light) out.push_back(luminance(l.irradiance));
  return out;
}

// A panel lights all places, too, but is not asked about.
TEST_F(DirectLightOnDevice, IsThatOfPunctualLightsAlone) {
  scene::Scene scene = blocks_under_punctual_lights();
  const uint32_t panel = scene::add_material(scene, "panel", {}, Rgb{5, 5, 5});
  scene::add_rectangle(scene, {-4, 4, -4, 4}, 9, false, panel);
  const transport::Elements elements = places_of(scene, 2000);
  const Lights lights = collect_lights(scene);
  ASSERT_FALSE(lights.triangles.empty());
  const auto on_processor = trace::RayTracer::build(scene);
  const auto on_device = trace::DeviceRayTracer::build(*device_, scene);
  ASSERT_TRUE(on_processor && on_device);
  std::vector<Receiver> receivers;
  for (size_t i = 0; i < elements.size(); ++i)
    receivers.push_back(
        {elements.position[i], elements.normal[i], elements.geometric_normal[i], hash64(3, i)});
  std::vector<LightAt> expected(receivers.size()), found(receivers.size());
  ShadowRayBatch batch;
  punctual_light_at({scene, lights, *on_processor}, 8, receivers, batch, expected);
  auto device = DeviceDirectLight::make(*on_device, *commands_, scene, lights);
  ASSERT_TRUE(device);
  Progress progress;
  const auto rays =
      device->light_at(receivers, {.samples = 8, .punctual_alone = true}, found, progress);
  ASSERT_TRUE(rays);
  EXPECT_EQ(*rays, batch.rays.size());
  const Differences d = differences(luminances(found), luminances(expected));
  EXPECT_LT(d.rms, kMostRms);
  EXPECT_LT(std::abs(d.bias), kMostBias);
}

}  // namespace
}  // namespace luxel::light
