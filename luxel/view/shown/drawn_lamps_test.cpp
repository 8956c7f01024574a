// The frame after an edit, before any light of it is known. Skipped without a device.
#include "luxel/view/shown/drawn_lamps.h"

#include "luxel/base/file.h"
#include "luxel/export/baked_glb.h"
#include "luxel/scene/procedural.h"
#include "luxel/view/draw/device_test_support.h"
#include "tests/scratch_folder.h"

namespace luxel::view {
namespace {

constexpr uint32_t kDrawnSide = 96;

class DrawnLampsTest : public testing::OnDevice {
 protected:
  /// The Cornell box with its own lamp and a spot, baked as luxel-view bakes it.
  void bake() {
    scene::Scene scene = scene::cornell_box();
    scene::PunctualLight spot;
    spot.kind = scene::PunctualLight::Kind::spot, spot.name = "spot";
    spot.position = {0.3f, 0.5f, 0.2f}, spot.direction = normalize(Vec3{-0.2f, -1, 0.3f});
    spot.intensity = {3, 3, 3}, spot.inner_cone_rad = 0.3f, spot.outer_cone_rad = 0.6f;
    scene.lights = {spot};
    const auto glb = export_::scene_glb(scene);
    ASSERT_TRUE(glb && write_file_atomically(folder_.path / "box.glb", *glb));
    pipeline::BakeSettings settings;
    settings.scene = folder_.path / "box.glb", settings.output = folder_.path / "box";
    settings.resolution = 256, settings.samples = 64;
    const auto live = LiveBake::begin(settings);
    live->wait();
    auto nothing = nothing_shown(*commands_);
    ASSERT_TRUE(nothing);
    shown_.emplace(std::move(*nothing));
    std::string said;
    ASSERT_TRUE(take_news(live->take(), *commands_, *shown_, said)) << said;
    ASSERT_TRUE(settle(*commands_, *shown_));
    ASSERT_TRUE(shown_->has_last && !shown_->without_lamps.empty());
  }

  /// The light of surfaces as it is shown now.
  image::Image drawn() {
    const auto painter = make_painter(*device_, *shaders_, shown_->device, kDrawnSide, kDrawnSide);
    EXPECT_TRUE(painter);
    Frame frame = shown_->read->first;
    frame.show = Show::light;
    auto picture = painted_radiance(*commands_, {*shaders_, *painter, shown_->device}, frame);
    EXPECT_TRUE(picture);
    return std::move(*picture);
  }
  Status draw_lamps_of(const SceneNow& now) {
    const trace::CameraRays eye(shown_->read->first.camera, int(kDrawnSide), int(kDrawnSide));
    return draw_lamps(*commands_, now, eye, *shown_, lamps_);
  }

  void TearDown() override {
    lamps_ = {}, shown_.reset();
    OnDevice::TearDown();
  }

  testing_support::ScratchFolder folder_;
  std::optional<ShownScene> shown_;
  DrawnLamps lamps_;
};

double mean(const image::Image& picture) {
  double sum = 0;
  for (size_t i = 0; i < picture.data.size(); i += 4) sum += double(picture.data[i + 1]);
  return sum / double(picture.data.size() / 4);
}
double mean_difference(const image::Image& a, const image::Image& b) {
  double sum = 0;
  for (size_t i = 0; i < a.data.size(); i += 4)
    sum += double(std::abs(a.data[i + 1] - b.data[i + 1]));
  return sum / double(a.data.size() / 4);
}

// An edit that changes no light shows the same light: what is left out is what is drawn. At edges
// of shadows pixels and texels differ. A lamp that is turned off takes its light along at once.
TEST_F(DrawnLampsTest, AreAllOfTheLightThatIsLeftOut) {
  bake();
  if (HasFatalFailure()) return;
  SceneNow now = unedited(shown_->read->scene);
  ASSERT_TRUE(draw_lamps_of(now));
  EXPECT_EQ(light_now(shown_->device).lamp_count, 0u) << "the light of the bake has all";
  const image::Image before = drawn();

  ASSERT_TRUE(leave_out_lamps(*commands_, *shown_));
  ASSERT_TRUE(draw_lamps_of(now));
  EXPECT_EQ(lamp_share(*shown_), 1);
  const image::Image same = drawn();
  EXPECT_LT(mean_difference(before, same), 0.01 * mean(before));

  ASSERT_TRUE(draw_lamps_or_not(false, *commands_, *shown_));
  ASSERT_TRUE(draw_lamps_of(now));
  EXPECT_EQ(lamp_share(*shown_), 0);
  EXPECT_EQ(drawn().data, before.data) << "the light of the bake again";
  ASSERT_TRUE(draw_lamps_or_not(true, *commands_, *shown_));

  now.lamps[0].is_on = false;
  ASSERT_TRUE(draw_lamps_of(now));
  const image::Image off = drawn();
  EXPECT_LT(mean(off), 0.9 * mean(same));
  EXPECT_GT(mean(off), 0.3 * mean(same)) << "the light of the box's own lamp stays";
}

}  // namespace
}  // namespace luxel::view
