// A device relights as the processor does. Skipped without a device.
#include "luxel/solve/device/device_relighter.h"

#include <gmock/gmock.h>

#include "luxel/gpu/device_test_support.h"
#include "luxel/solve/matrix/relighter_test_support.h"

namespace luxel::device {
namespace {

using matrix::CodecKind;
using matrix::testing::kLeft;
using matrix::testing::kRight;
using matrix::testing::relative_error;

class RelighterOnDevice : public gpu::testing::OnDevice {
 protected:
  /// Both give the same light, to the rounding of sums in another order.
  void expect_the_same(matrix::RelightData data, const std::vector<matrix::RelightLights>& lights);
};

void RelighterOnDevice::expect_the_same(matrix::RelightData data,
                                        const std::vector<matrix::RelightLights>& lights) {
  auto on_device = DeviceRelighter::make(*device_, data);
  ASSERT_TRUE(on_device) << on_device.error().message;
  matrix::Relighter on_processor = matrix::testing::relighter_of(data);
  const std::vector<float> even(data.target.position.size(), 1.0f);
  for (const matrix::RelightLights& l : lights) {
    const matrix::Relit expected = matrix::testing::relit(on_processor, l);
    matrix::Relit found;
    ASSERT_TRUE(on_device->update(l));
    ASSERT_TRUE(on_device->read(found));
    EXPECT_LT(relative_error(found.indirect, expected.indirect, data.area_m2), 1e-5);
    EXPECT_LT(relative_error(found.indirect_at_points, expected.indirect_at_points, even), 1e-5);
    if (!l.punctual.empty()) {
      EXPECT_LT(relative_error(found.direct, expected.direct, data.area_m2), 1e-5);
    }
  }
}

const std::array kTwo{kLeft, kRight};
const std::array kOne{kRight};

/// Some lamps, none, others, and a sky.
std::vector<matrix::RelightLights> changing_lights() {
  return {{kTwo}, {{}, {}, {1, 2, 3}}, {kOne, {}, {0.5f, 0.1f, 0.1f}}};
}

// By both codecs, with all bounces and some.
TEST_F(RelighterOnDevice, IsThatOfTheProcessor) {
  for (const CodecKind codec : {CodecKind::hierarchical, CodecKind::bc1})
    for (const int bounces : {-1, 0, 2}) {
      matrix::RelightParams params = matrix::testing::small(codec);
      params.bounces = bounces;
      const matrix::testing::Stage stage(scene::cornell_box(), params);
      expect_the_same(stage.data(matrix::testing::floor_places(0.55f)), changing_lights());
    }
}

// Glowing materials of other colours, and a spot and a sun.
TEST_F(RelighterOnDevice, KnowsGlowAndAllKindsOfLights) {
  const matrix::testing::Stage stage(scene::cornell_box(),
                                     matrix::testing::small(CodecKind::hierarchical));
  matrix::RelightData data = stage.data(matrix::testing::floor_places(0.55f));
  const std::vector<Rgb> emission(data.material_name.size(), Rgb{3, 2, 1});
  scene::PunctualLight spot = kLeft, sun;
  spot.kind = scene::PunctualLight::Kind::spot, spot.range_m = 2;
  spot.direction = {0, -1, 0}, spot.outer_cone_rad = 0.9f, spot.inner_cone_rad = 0.2f;
  sun.kind = scene::PunctualLight::Kind::directional;
  sun.direction = normalize(Vec3{0.1f, -0.2f, -1});
  const std::vector<scene::PunctualLight> lamps{spot, sun};
  expect_the_same(data, {{lamps, emission}});
  std::vector<Rgb> at_probes;
  for (size_t k = 0; k < data.probe.size(); ++k) at_probes.push_back(Rgb{1, 2, 3} * float(k % 5));
  expect_the_same(data, {{lamps, {}, {}, at_probes}});
}

// The processor's light is that of no ceiling: LiveLight.ALampAHairAboveTheCeilingIsSeen.
TEST_F(RelighterOnDevice, SeesALampInASurface) {
  const scene::Scene box = scene::cornell_box();
  scene::PunctualLight lamp = kLeft;
  lamp.position.y = scene::world_bounds(box).upper.y;
  const std::vector<scene::PunctualLight> lamps{lamp};
  const matrix::testing::Stage stage(box, matrix::testing::small(CodecKind::hierarchical));
  expect_the_same(stage.data(matrix::testing::floor_places(0.55f)), {{lamps}});
}

TEST_F(RelighterOnDevice, RefusesOtherCodecs) {
  const matrix::testing::Stage stage(scene::cornell_box(),
                                     matrix::testing::small(CodecKind::dense16));
  const matrix::RelightData data = stage.data();
  const auto made = DeviceRelighter::make(*device_, data);
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().code, ErrorCode::unsupported);
  EXPECT_THAT(made.error().message, ::testing::HasSubstr("hierarchical or bc1"));
}

}  // namespace
}  // namespace luxel::device
