// Moved lamps in another .lxr file: what is read back, and its light, against the desk that they
// were moved on.
#include "luxel/view/relight/save_lxr.h"

#include <gtest/gtest.h>

#include "luxel/base/file.h"
#include "luxel/export/baked_glb.h"
#include "luxel/import/import.h"
#include "luxel/scene/digest.h"
#include "luxel/scene/procedural.h"
#include "luxel/solve/matrix/lxr.h"
#include "luxel/solve/matrix/relight.h"
#include "luxel/trace/ray_tracer.h"
#include "luxel/view/relight/lamp_script.h"
#include "luxel/view/relight/open_lxr.h"
#include "luxel/view/relight/relit_light.h"
#include "tests/scratch_folder.h"

namespace luxel::view {
namespace {

/// The Cornell box, whose own lamp glows, with two lamps more, lit on some places of its floor.
matrix::RelightData data_to_save() {
  scene::Scene scene = scene::cornell_box();
  for (const float x : {0.1f, 0.4f}) {
    scene::PunctualLight lamp;
    lamp.name = x < 0.2f ? "left" : "right", lamp.position = {x, 0.4f, 0.1f};
    lamp.intensity = {0.2f, 0.1f, 0.3f};
    scene.lights.push_back(lamp);
  }
  matrix::Target target;
  target.kind = matrix::Target::Kind::texels, target.width = target.height = 8;
  for (uint16_t k = 0; k < 8; ++k) {
    target.texel.push_back({k, 3});
    target.position.push_back({0.06f * float(k + 1), 0, 0.05f});
    target.normal.push_back({0, 1, 0}), target.geometric_normal.push_back({0, 1, 0});
  }
  matrix::RelightParams params;
  params.patches.count = 200, params.factors.rays_per_patch = 128;
  params.codec = matrix::CodecKind::dense32;
  Progress progress;
  auto data =
      matrix::make_relight_data(scene, *trace::RayTracer::build(scene), target, params, progress);
  EXPECT_TRUE(data) << data.error().message;
  data->baked_error = 0.25, data->lamp_error = 0.5;
  data->scene_glb = *export_::scene_glb(scene);
  data->origin = {512344, 88, -5403216};
  return std::move(*data);
}

/// One moved, one off, a sun more, the glow red, and a wall that glows now.
Lamps moved(const Lamps& baked) {
  Lamps out = baked;
  out.lamps[0].light.position = {0.3f, 0.2f, 0.4f};
  out.lamps[1].is_on = false;
  Lamp sun;
  sun.light.kind = scene::PunctualLight::Kind::directional, sun.light.name = "sun";
  sun.light.direction = normalize(Vec3{0.3f, -0.4f, 1}), sun.light.intensity = {0.5f, 0.6f, 0.7f};
  sun.light.angular_radius_rad = 0.03f;
  out.lamps.push_back(sun);
  for (Glow& glow : out.glows) {
    if (max_component(glow.radiance) > 0) glow.radiance = {3, 0.5f, 0};
    if (glow.name == "green") glow.radiance = {0, 0.2f, 0};
  }
  return out;
}

void expect_same_lamp(const scene::PunctualLight& a, const scene::PunctualLight& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_TRUE(a.kind == b.kind && a.position == b.position && a.direction == b.direction);
  EXPECT_TRUE(a.range_m == b.range_m && a.angular_radius_rad == b.angular_radius_rad);
  EXPECT_EQ(a.intensity, b.intensity) << a.name;
}

class SavedLxr : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto file = save_lxr({folder_.path / "box.lxr", &data_, lamps_of(data_), now_});
    ASSERT_TRUE(file) << file.error().message;
    EXPECT_EQ(*file, folder_.path / "box-lamps.lxr");
    auto saved = matrix::read_lxr(*file);
    ASSERT_TRUE(saved) << saved.error().message;
    saved_ = std::move(*saved);
  }

  testing_support::ScratchFolder folder_;
  const matrix::RelightData data_ = data_to_save();
  const Lamps now_ = moved(lamps_of(data_));
  matrix::RelightData saved_;
};

TEST_F(SavedLxr, HasTheLampsOfTheDeskAndAllElseAsItWas) {
  const Lamps back = lamps_of(saved_);
  ASSERT_EQ(back.lamps.size(), 3u);
  for (size_t i = 0; i < 3; ++i) {
    scene::PunctualLight wanted = now_.lamps[i].light;
    if (i == 1) wanted.intensity = {};  // it is off
    expect_same_lamp(back.lamps[i].light, wanted);
  }
  ASSERT_EQ(back.glows.size(), now_.glows.size());
  for (size_t m = 0; m < back.glows.size(); ++m)
    EXPECT_LE(length(back.glows[m].radiance - now_.glows[m].radiance), 1e-5f) << back.glows[m].name;
  matrix::RelightData same = saved_;
  same.lights = data_.lights, same.background = data_.background, same.emission = data_.emission;
  same.scene_glb = data_.scene_glb;
  EXPECT_EQ(same.baked_error, 0) << "nobody has measured it";
  same.baked_error = data_.baked_error;
  EXPECT_EQ(matrix::encode_lxr(same), matrix::encode_lxr(data_));
}

TEST_F(SavedLxr, IsOpenedWhereItLies) {
  const auto opened = opened_lxr(saved_, "box-lamps.lxr", nullptr);
  ASSERT_TRUE(opened) << opened.error().message;
  EXPECT_EQ(opened->read->scene.origin, data_.origin);
  EXPECT_LT(length(scene::world_bounds(opened->read->scene).centre()), 1);
}

TEST_F(SavedLxr, LampsAreWrittenInTheWorldOfTheFile) {
  pipeline::LightScript script;
  script.lights.push_back({{}, {{{0, {1, 1, 1}}}}, {{{0, {1.678f, -0.5f, 5.877f}}}}, {}});
  script.lights[0].direction.keys = {{0, {0, -1, 0}}};
  ASSERT_TRUE(write_lamps(folder_.path / "box.lxr", script, data_.origin));
  const auto bytes = read_file(script_beside(folder_.path / "box.lxr"));
  ASSERT_TRUE(bytes);
  const std::string text(reinterpret_cast<const char*>(bytes->data()), bytes->size());
  EXPECT_NE(text.find("512345.678"), std::string::npos) << text;
}

TEST_F(SavedLxr, HasTheSceneWithThoseLamps) {
  const auto before = import::import_glb(data_.scene_glb, "before"),
             after = import::import_glb(saved_.scene_glb, "after");
  ASSERT_TRUE(before && after);
  ASSERT_EQ(after->scene.lights.size(), 3u);
  for (size_t i = 0; i < 3; ++i) {
    const scene::PunctualLight& a = after->scene.lights[i];
    const scene::PunctualLight& b = saved_.lights[i];
    EXPECT_LE(length(a.intensity - b.intensity), 1e-6f);
    EXPECT_LE(length(a.position - b.position), 1e-6f);
    EXPECT_NEAR(a.angular_radius_rad, b.angular_radius_rad, 1e-6);
  }
  for (const scene::Material& material : after->scene.materials)
    for (const Glow& glow : now_.glows)
      if (glow.name == material.name) {
        EXPECT_LE(length(material.emission - glow.radiance), 1e-5f) << material.name;
      }
  const auto others = [](const scene::Scene& scene) {
    scene::Scene out = scene;
    out.lights.clear();
    for (scene::Material& material : out.materials) material.emission = {};
    std::vector<uint64_t> digests;
    for (const scene::ItemDigest& item : scene::digests_of(out)) digests.push_back(item.digest);
    return digests;
  };
  EXPECT_EQ(others(after->scene), others(before->scene));
}

TEST_F(SavedLxr, HasTheLightOfTheDesk) {
  auto desk = make_relit_light(data_);
  auto file = matrix::Relighter::make(saved_, {});
  ASSERT_TRUE(desk && file);
  relight(now_, *desk);
  file->update({.punctual = saved_.lights, .background = saved_.background});
  const std::vector<Rgb>& want = desk->relighter.latest().indirect_at_points;
  const std::vector<Rgb>& got = file->latest().indirect_at_points;
  ASSERT_EQ(got.size(), want.size());
  double sum = 0;
  for (size_t k = 0; k < got.size(); ++k) {
    EXPECT_LE(length(got[k] - want[k]), 1e-4f * (length(want[k]) + 1e-3f)) << k;
    sum += double(luminance(want[k]));
  }
  EXPECT_GT(sum, 0);
}

TEST_F(SavedLxr, IsNeverWrittenOver) {
  const LampsToSave again{folder_.path / "box.lxr", &data_, lamps_of(data_), now_};
  const auto second = save_lxr(again);
  ASSERT_TRUE(second);
  EXPECT_EQ(*second, folder_.path / "box-lamps-2.lxr");
  LampsToSave bright = again;
  bright.now.lamps[0].light.intensity = {1e31f, 0, 0};
  const auto refused = save_lxr(bright);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().message.find("these lamps cannot be stored in a file: "), 0u);
}

}  // namespace
}  // namespace luxel::view
