// Marks over a picture.
#include "luxel/scene/procedural.h"
#include "luxel/view/draw/device_test_support.h"

namespace luxel::view {
namespace {

class MarkTest : public testing::OnDevice {};

TEST_F(MarkTest, DiscsAndLinesLieWhereTheyAreAsked) {
  scene::Scene scene = scene::cornell_box();
  for (scene::Material& material : scene.materials) material.emission = {};
  scene.background = {1e-9f, 1e-9f, 1e-9f};  // black: without one there would be grey
  pipeline::LightmapPages black;
  black.pictures.emplace_back(1, 1, 4);
  black.of_material.assign(scene.materials.size(), 0);
  const auto on_device = put_on_device(*commands_, scene, black);
  ASSERT_TRUE(on_device) << on_device.error().message;
  const auto painter = make_painter(*device_, *shaders_, *on_device, 60, 40);
  ASSERT_TRUE(painter) << painter.error().message;
  Frame frame;
  frame.camera = scene.cameras[0];
  frame.marks = {{{10.5f, 5.5f}, {40.5f, 5.5f}, 2, {0, 1, 0}, {0, 0, 0}, 0},
                 {{40.5f, 20.5f}, {40.5f, 20.5f}, 5, {1, 0, 0}, {0, 0, 1}, 3}};
  const auto picture = painted(*commands_, {*shaders_, *painter, *on_device}, frame);
  ASSERT_TRUE(picture) << picture.error().message;
  const auto pixel = [&](size_t x, size_t y) {
    const uint8_t* p = picture->data.data() + 3 * (60 * y + x);
    return std::array{p[0], p[1], p[2]};
  };
  const std::array<uint8_t, 3> nothing{0, 0, 0}, red{255, 0, 0}, green{0, 255, 0}, blue{0, 0, 255};
  EXPECT_EQ(pixel(40, 20), red);
  EXPECT_EQ(pixel(44, 20), red);
  EXPECT_EQ(pixel(40, 14), blue) << "its edge";
  EXPECT_EQ(pixel(40, 30), nothing);
  EXPECT_EQ(pixel(25, 5), green);
  EXPECT_EQ(pixel(25, 7), pixel(25, 3)) << "as far to both sides";
  EXPECT_EQ(pixel(25, 9), nothing);
  EXPECT_EQ(pixel(9, 5), green) << "its round end";
  EXPECT_EQ(pixel(6, 5), nothing);
}

}  // namespace
}  // namespace luxel::view
