// A device's paths are those of the processor. Skipped without a device.
#include "luxel/reference/device/device_path_tracer.h"

#include <gmock/gmock.h>

#include "luxel/base/differences.h"
#include "luxel/base/random.h"
#include "luxel/gpu/device_test_support.h"
#include "luxel/reference/reference_test_support.h"
#include "luxel/scene/light_kinds.h"
#include "luxel/scene/procedural.h"
#include "luxel/scene/sides.h"
#include "luxel/trace/camera_rays.h"

namespace luxel::reference {
namespace {

std::vector<float> luminances(std::span<const Rgb> light) {
  std::vector<float> out;
  for (const Rgb& l : light) out.push_back(luminance(l));
  return out;
}

// A path is another one from where rounding has it meet another surface: one of some hundred
// receivers then differs by a path or two of its many. Over all of them that evens out.
constexpr double kMostRms = 5e-3, kMostBias = 1e-3;

class PathsOnDevice : public gpu::testing::OnDevice {
 protected:
  void SetUp() override {
    OnDevice::SetUp();
    if (device_ && !device_->has_doubles) GTEST_SKIP() << "the device has no double precision";
  }
  void expect_the_same(const scene::Scene& scene, const PathParams& params, size_t places = 400);
};

void PathsOnDevice::expect_the_same(const scene::Scene& scene, const PathParams& params,
                                    size_t places) {
  const testing::Points points = testing::random_points(scene, places, 5);
  const Receivers receivers{points.position, points.normal, points.normal};
  const auto tracer = trace::RayTracer::build(scene);
  ASSERT_TRUE(tracer);
  auto on_device = DevicePathTracer::make(*device_, scene, *tracer);
  ASSERT_TRUE(on_device) << on_device.error().message;
  Progress progress;
  const auto expected = irradiance_by_paths(scene, receivers, *tracer, params, progress);
  const auto found = on_device->irradiance(receivers, params, progress);
  ASSERT_TRUE(expected && found);
  const Differences d =
      differences(luminances(found->irradiance), luminances(expected->irradiance));
  EXPECT_LT(d.rms, kMostRms);
  EXPECT_LT(std::abs(d.bias), kMostBias);
  EXPECT_NEAR(found->relative_error, expected->relative_error, 0.01 * expected->relative_error);
  EXPECT_NEAR(double(found->rays), double(expected->rays), 1e-3 * double(expected->rays));
  EXPECT_EQ(found->enclosed, expected->enclosed);
}

/// A room under a bright sky, lit by all kinds of lights, with textures, a mask, a sphere with
/// smooth normals, and a sheet with two sides.
scene::Scene a_bit_of_everything() {
  scene::Scene scene;
  scene.background = {0.05f, 0.05f, 0.1f};
  scene.environment.width = 8, scene.environment.height = 4;
  for (int k = 0; k < 32; ++k)
    scene.environment.radiance.push_back(Rgb{0.2f, 0.15f, 0.1f} * float(1 + k % 5));
  scene.environment.radiance[5] = {20, 18, 15};
  scene.environment.rotation_rad = 0.4f;
  scene::Texture texture;
  texture.width = texture.height = 4;
  for (int k = 0; k < 16; ++k)
    for (const int c : {40 + 13 * k, 250 - 9 * k, 128, k % 3 == 0 ? 0 : 255})
      texture.rgba.push_back(uint8_t(c));
  scene.textures.push_back(texture);
  const uint32_t painted = scene::add_material(scene, "painted", {0.9f, 0.8f, 0.7f}, {});
  const uint32_t mask = scene::add_material(scene, "mask", {0.7f, 0.7f, 0.7f}, {});
  const uint32_t lamp = scene::add_material(scene, "lamp", {0.1f, 0.1f, 0.1f}, {6, 5, 4});
  const uint32_t smooth = scene::add_material(scene, "smooth", {0.6f, 0.7f, 0.8f}, {});
  scene.materials[painted].base_color_texture.texture = 0;
  scene.materials[painted].metallic = 0.5f;
  scene.materials[painted].metallic_texture.texture = 0;
  scene.materials[mask].base_color_texture.texture = 0;
  scene.materials[mask].base_color_texture.filter = scene::Filter::nearest;
  scene.materials[mask].alpha_mode = scene::AlphaMode::mask;
  scene.materials[mask].double_sided = true;
  scene.materials[lamp].emission_texture.texture = 0;
  scene.materials[lamp].double_sided = true;
  scene::add_rectangle(scene, {-2, 2, -2, 2}, 0, true, painted);
  scene::add_rectangle(scene, {-1, 1, -1, 1}, 0.7f, true, mask);
  scene::add_rectangle(scene, {-1.5f, -1.2f, -1.5f, -1.2f}, 1.5f, false, lamp);
  for (scene::Mesh& mesh : scene.meshes)
    for (const Vec3& p : mesh.positions) mesh.uv0.push_back({0.7f * p.x, 0.7f * p.z});
  scene::add_backs(scene, scene.instances[1].mesh, std::vector<uint8_t>{1, 1});
  scene::place(scene, scene::sphere("ball", 0.3f, 12, 8, smooth), translation({0.3f, 0.3f, 0.2f}));
  scene::PunctualLight sun, spot, point;
  sun.kind = scene::LightKind::directional, sun.angular_radius_rad = 0.05f;
  sun.direction = normalize(Vec3{1, -2, 0.5f});
  spot.kind = scene::LightKind::spot, spot.position = {1, 2, 1}, spot.intensity = {4, 4, 2};
  spot.inner_cone_rad = 0.3f, spot.outer_cone_rad = 0.6f, spot.range_m = 5;
  point.position = {-1, 0.4f, 1}, point.intensity = {0.3f, 0.4f, 0.5f};
  scene.lights = {sun, spot, point};
  return scene;
}

TEST_F(PathsOnDevice, AreThoseOfTheProcessor) {
  expect_the_same(scene::cornell_box(), {.samples = 100, .seed = 3});
  expect_the_same(scene::cornell_box(), {.samples = 64, .bounces = 1});
  scene::Scene scene = a_bit_of_everything();
  expect_the_same(scene, {.samples = 150, .seed = 9});
  scene.meshes[1].alphas.assign(scene.meshes[1].positions.size(), 0.1f);
  scene.meshes[1].alphas[0] = 1;
  for (scene::Material& m : scene.materials)
    if (m.alpha_mode == scene::AlphaMode::mask) m.emission = {2, 1, 3};
  expect_the_same(scene, {.samples = 150, .seed = 9});
}

// Under an even sky E = pi L, however the path begins; with points of a receiver in turn.
TEST_F(PathsOnDevice, HaveTheLightOfAnEvenSky) {
  scene::Scene scene;
  scene.background = {1, 2, 3};
  const uint32_t black = scene::add_material(scene, "black", {0, 0, 0}, {});
  scene::add_rectangle(scene, {-1, 1, -1, 1}, 0, true, black);
  const auto tracer = trace::RayTracer::build(scene);
  ASSERT_TRUE(tracer);
  auto on_device = DevicePathTracer::make(*device_, scene, *tracer);
  ASSERT_TRUE(on_device);
  const std::vector<Vec3> position{{0, 1e-6f, 0}, {0.1f, 1e-6f, 0}, {0.2f, 1e-6f, 0}},
      normal(3, {0, 1, 0});
  const std::vector<uint32_t> first{0, 2, 3};
  Progress progress;
  const auto found =
      on_device->irradiance({position, normal, normal, first}, {.samples = 33}, progress);
  ASSERT_TRUE(found);
  ASSERT_EQ(found->irradiance.size(), 2u);
  for (const Rgb& e : found->irradiance) EXPECT_LE(length(e - Rgb{1, 2, 3} * kPi), 1e-4f);
  const auto nobody = on_device->irradiance({}, {.samples = 33}, progress);
  ASSERT_TRUE(nobody);
  EXPECT_TRUE(nobody->irradiance.empty());
  progress.request_cancel();
  EXPECT_FALSE(on_device->irradiance({position, normal, normal, first}, {.samples = 33}, progress));
}

// E = I / h^2 straight below a lamp in the ceiling.
TEST_F(PathsOnDevice, HaveTheLightOfALampInASurface) {
  scene::Scene scene;
  const uint32_t black = scene::add_material(scene, "black", {0, 0, 0}, {});
  scene::add_rectangle(scene, {-5, 5, -5, 5}, 0, true, black);
  scene::add_rectangle(scene, {-5, 5, -5, 5}, 3, false, black);
  scene::PunctualLight lamp;
  lamp.intensity = {900, 900, 900};
  const std::vector<Vec3> position{{0, 1e-6f, 0}}, normal{{0, 1, 0}};
  for (const float above : {0.0f, 1e-5f}) {
    lamp.position = {0, 3 + above, 0}, scene.lights = {lamp};
    const auto tracer = trace::RayTracer::build(scene);
    ASSERT_TRUE(tracer);
    auto on_device = DevicePathTracer::make(*device_, scene, *tracer);
    ASSERT_TRUE(on_device);
    Progress progress;
    const auto found = on_device->irradiance({position, normal, normal}, {.samples = 4}, progress);
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->irradiance[0].x, 100, 1e-2f) << above;
  }
}

TEST_F(PathsOnDevice, MakeTheSamePicture) {
  const scene::Scene scene = a_bit_of_everything();
  const auto tracer = trace::RayTracer::build(scene);
  ASSERT_TRUE(tracer);
  auto on_device = DevicePathTracer::make(*device_, scene, *tracer);
  ASSERT_TRUE(on_device);
  scene::Camera camera;
  camera.world_from_camera = scene::look_at({2, 1.5f, 2.5f}, {0, 0.3f, 0}, {0, 1, 0});
  const PathParams params{.samples = 24};
  Progress progress;
  const auto expected = radiance_by_paths(scene, *tracer, camera, 32, 24, params, progress);
  const auto found = on_device->radiance(camera, 32, 24, params, progress);
  ASSERT_TRUE(expected && found);
  std::vector<float> f, e, cover_f, cover_e;
  for (int y = 0; y < 24; ++y)
    for (int x = 0; x < 32; ++x) {
      f.push_back(luminance(found->radiance.rgb(x, y)));
      e.push_back(luminance(expected->radiance.rgb(x, y)));
      cover_f.push_back(found->radiance.at(x, y)[3]);
      cover_e.push_back(expected->radiance.at(x, y)[3]);
    }
  const Differences d = differences(f, e), cover = differences(cover_f, cover_e);
  EXPECT_LT(d.rms, 0.02);  // a pixel has 24 paths
  EXPECT_LT(std::abs(d.bias), kMostBias);
  EXPECT_LT(cover.rms, 2e-3);
  EXPECT_NEAR(found->relative_error, expected->relative_error, 0.02 * expected->relative_error);
}

TEST_F(PathsOnDevice, RefuseWhatTheyDoNotKnow) {
  scene::Scene glass = scene::cornell_box(), profile = scene::cornell_box();
  glass.materials[0].transmission = 1, glass.materials[0].base_color = {0.5f, 1, 1};
  profile.profiles.emplace_back();
  profile.lights.emplace_back().profile = 0;
  for (const auto& [scene, word] :
       {std::pair(&glass, "coloured glass"), std::pair(&profile, "light profiles")}) {
    const auto tracer = trace::RayTracer::build(*scene);
    ASSERT_TRUE(tracer);
    const auto made = DevicePathTracer::make(*device_, *scene, *tracer);
    ASSERT_FALSE(made);
    EXPECT_EQ(made.error().code, ErrorCode::unsupported);
    EXPECT_THAT(made.error().message, ::testing::HasSubstr(word));
  }
}

}  // namespace
}  // namespace luxel::reference
