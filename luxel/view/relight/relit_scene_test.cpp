// A lamp that is dragged, against a new bake of the scene with the lamp where it has come to.
#include "luxel/view/relight/relit_scene.h"

#include <algorithm>
#include <cstring>
#include <nlohmann/json.hpp>
#include <numeric>

#include "luxel/base/file.h"
#include "luxel/export/baked_glb.h"
#include "luxel/image/color.h"
#include "luxel/image/flip.h"
#include "luxel/image/half.h"
#include "luxel/pipeline/bake/bake.h"
#include "luxel/pipeline/command/relight.h"
#include "luxel/scene/procedural.h"
#include "luxel/view/draw/device_structs.h"
#include "luxel/view/draw/device_test_support.h"
#include "luxel/view/model/projection.h"
#include "luxel/view/open_bake.h"
#include "luxel/view/relight/lamp_desk.h"
#include "tests/scratch_folder.h"

namespace luxel::view {
namespace {

constexpr uint32_t kShotSide = 128;

/// The Cornell box with a point lamp instead of its own.
scene::Scene box_with_lamp(const scene::PunctualLight& lamp) {
  scene::Scene scene = scene::cornell_box();
  for (scene::Material& material : scene.materials) material.emission = {};
  scene.lights = {lamp};
  return scene;
}

scene::PunctualLight warm_lamp(Vec3 position) {
  scene::PunctualLight lamp;
  lamp.name = "lamp", lamp.position = position, lamp.intensity = {0.4f, 0.35f, 0.3f};
  return lamp;
}

/// Linear light of display values, as image::flip() takes it.
image::Image linear(const image::Image8& picture) {
  image::Image out(picture.width, picture.height, 3);
  for (size_t i = 0; i < out.data.size(); ++i)
    out.data[i] = image::linear_from_srgb(float(picture.data[i]) / 255);
  return out;
}

double mean_flip(const image::Image8& a, const image::Image8& b) {
  const image::Image flip = image::flip(linear(a), linear(b));
  return std::accumulate(flip.data.begin(), flip.data.end(), 0.0) / double(flip.data.size());
}

class RelitSceneTest : public testing::OnDevice {
 protected:
  std::filesystem::path write_scene(const scene::Scene& scene, const std::string& name) const {
    const auto glb = export_::scene_glb(scene);
    EXPECT_TRUE(glb && write_file_atomically(folder_.path / name, *glb));
    return folder_.path / name;
  }

  OpenedLxr prepared(const scene::Scene& scene) const {
    pipeline::RelightSettings settings;
    settings.scene = write_scene(scene, "scene.glb"), settings.output = folder_.path / "scene.lxr";
    settings.resolution = 128;
    settings.matrix.patches.count = 1500, settings.matrix.factors.rays_per_patch = 1024;
    Progress progress;
    const auto report = pipeline::relight(settings, progress);
    EXPECT_TRUE(report) << report.error().message;
    auto opened = open_lxr(settings.output);
    EXPECT_TRUE(opened) << opened.error().message;
    return std::move(*opened);
  }

  /// The picture of a bake of a scene.
  image::Image8 baked(const scene::Scene& scene, const Frame& frame) {
    pipeline::BakeSettings settings;
    settings.scene = write_scene(scene, "moved.glb"), settings.output = folder_.path / "moved";
    settings.resolution = 256, settings.samples = 128;
    Progress progress;
    const auto report = pipeline::bake(settings, progress);
    EXPECT_TRUE(report) << report.error().message;
    const auto bake = open_bake(settings.output);
    EXPECT_TRUE(bake) << bake.error().message;
    const auto on_device = put_on_device(*commands_, bake->scene, bake->lightmaps);
    EXPECT_TRUE(on_device);
    return drawn(*on_device, frame);
  }

  image::Image8 drawn(const DeviceScene& scene, const Frame& frame) {
    const auto painter = make_painter(*device_, *shaders_, scene, kShotSide, kShotSide);
    EXPECT_TRUE(painter) << painter.error().message;
    auto picture = painted(*commands_, {*shaders_, *painter, scene}, frame);
    EXPECT_TRUE(picture) << picture.error().message;
    return std::move(*picture);
  }

  testing_support::ScratchFolder folder_;
};

class DraggedLamp : public RelitSceneTest, public ::testing::WithParamInterface<PatchLight> {};

INSTANTIATE_TEST_SUITE_P(PatchesLit, DraggedLamp,
                         ::testing::Values(PatchLight::by_rays, PatchLight::by_maps,
                                           PatchLight::on_device));

TEST_P(DraggedLamp, IsWhereABakeHasIt) {
  OpenedLxr opened = prepared(box_with_lamp(warm_lamp({0.1f, 0.45f, 0.3f})));
  auto relit = lxr_shown(*commands_, GetParam(), opened);
  ASSERT_TRUE(relit) << relit.error().message;
  DeviceScene& device = relit->shown.device;
  const Box3 bounds = scene::world_bounds(opened.read->scene);
  const PlaceSeen nowhere = [](const Frame&, Vec2) { return std::nullopt; };
  Walk walk = begin_walk(opened.read->first, bounds, kShotSide, kShotSide, nowhere);
  LampDesk desk = begin_desk(opened.lamps, bounds);
  const image::Image8 before = drawn(device, walk.shown);

  const Vec2 from = *pixel_of(walk, desk.lamps.lamps[0].light.position);
  const Event events[] = {PointerMoved{from + Vec2{3, 2}}, ButtonChanged{Button::left, true},
                          PointerMoved{from + Vec2{-40, 0}}, ButtonChanged{Button::left, false}};
  for (const Event& event : events)
    if (!handle_lamps(event, walk, desk)) handle(event, nowhere, walk);
  ASSERT_TRUE(follow_lamps(*commands_, desk.lamps, nullptr, opened, relit->lamps, device));
  const image::Image8 after = drawn(device, walk.shown);

  const scene::PunctualLight& moved = desk.lamps.lamps[0].light;
  EXPECT_GT(length(moved.position - opened.lamps.lamps[0].light.position), 0.1f);
  const image::Image8 wanted = baked(box_with_lamp(moved), walk.shown);
  EXPECT_LT(mean_flip(after, wanted), 0.05);
  EXPECT_GT(mean_flip(before, wanted), 0.1);
}

/// The halves that the device has made, times their scale.
std::vector<float> light_on_device(gpu::Commands& commands, const RelitOnDevice& relit,
                                   const DeviceScene& scene) {
  const auto here = gpu::make_buffer(commands.device(), relit.halves.size, gpu::Access::to_host,
                                     "the light of a map");
  EXPECT_TRUE(here && gpu::copy_bytes(commands, relit.halves, *here, here->size));
  const float scale = scales_of(scene)[0];
  std::vector<float> out;
  for (size_t i = 0; i < here->size / sizeof(uint16_t); ++i) {
    uint16_t bits = 0;
    std::memcpy(&bits, here->mapped + i * sizeof bits, sizeof bits);
    out.push_back(image::from_half(bits) * scale);
  }
  return out;
}

// Texels, gutters and what is black, to the steps of halves; then after a lamp has become a
// thousand times as bright, which has another scale.
TEST_F(RelitSceneTest, HasOnTheDeviceTheLightOfTheProcessor) {
  OpenedLxr opened = prepared(box_with_lamp(warm_lamp({0.1f, 0.45f, 0.3f})));
  auto relit = lxr_shown(*commands_, PatchLight::on_device, opened);
  ASSERT_TRUE(relit) << relit.error().message;
  ASSERT_TRUE(relit->lamps.relit);
  Lamps lamps = opened.lamps;
  for (const float factor : {1.0f, 1000.0f}) {
    lamps.lamps[0].light.intensity = opened.lamps.lamps[0].light.intensity * factor;
    lamps.lamps[0].light.position.x -= 0.05f;
    ASSERT_TRUE(
        follow_lamps(*commands_, lamps, nullptr, opened, relit->lamps, relit->shown.device));
    relight(lamps, opened.light);
    const std::vector<float>& expected = opened.light.indirect.data;
    const std::vector<float> found =
        light_on_device(*commands_, *relit->lamps.relit, relit->shown.device);
    ASSERT_EQ(found.size(), expected.size());
    const float largest = *std::ranges::max_element(expected);
    EXPECT_GT(largest, 0);
    for (size_t i = 0; i < found.size(); ++i)
      ASSERT_NEAR(found[i], expected[i], 1e-3f * expected[i] + 1e-5f * largest) << i;
  }
}

}  // namespace
}  // namespace luxel::view
