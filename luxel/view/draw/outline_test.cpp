// A line around what is selected, and scenes that are changed where they lie.
#include "luxel/scene/procedural.h"
#include "luxel/view/draw/device_test_support.h"

namespace luxel::view {
namespace {

constexpr uint32_t kOutlineWidth = 120, kOutlineHeight = 80;

/// Black light for all materials of a scene.
pipeline::LightmapPages no_light(const scene::Scene& scene) {
  pipeline::LightmapPages out;
  out.pictures.emplace_back(1, 1, 4);
  out.of_material.assign(scene.materials.size(), 0);
  return out;
}

class OutlineTest : public testing::OnDevice {
 protected:
  DeviceScene put(const scene::Scene& scene) {
    auto out = put_on_device(*commands_, scene, no_light(scene));
    EXPECT_TRUE(out) << out.error().message;
    return std::move(*out);
  }
  image::Image8 draw(const DeviceScene& scene, const Frame& frame) {
    const auto painter = make_painter(*device_, *shaders_, scene, kOutlineWidth, kOutlineHeight);
    EXPECT_TRUE(painter) << painter.error().message;
    const auto picture = painted(*commands_, {*shaders_, *painter, scene}, frame);
    EXPECT_TRUE(picture) << picture.error().message;
    return *picture;
  }
};

std::array<uint8_t, 3> pixel(const image::Image8& picture, size_t x, size_t y) {
  const uint8_t* p = picture.data.data() + 3 * (kOutlineWidth * y + x);
  return {p[0], p[1], p[2]};
}

/// Squares of 4 m and 1 m by 1 m, in two materials each, seen by parallel rays: a pixel is 0.1 m.
/// The small one stands behind the large one, 2.5 m to the right: it is seen in part.
scene::Scene squares_side_by_side() {
  scene::Scene out;
  out.materials.resize(2);
  for (const float half : {2.0f, 0.5f}) {
    scene::Mesh& mesh = out.meshes.emplace_back();
    mesh.positions = {{-half, -half, 0}, {0, -half, 0},    {0, half, 0},
                      {-half, half, 0},  {half, -half, 0}, {half, half, 0}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {1, 4, 5}, {1, 5, 2}};
    mesh.triangle_material = {0, 0, 1, 1};
  }
  out.instances = {{"large", 0, {}}, {"small", 1, translation({2, 0, -1})}};
  return out;
}

Frame from_the_front() {
  Frame out;
  out.camera.world_from_camera.row[2][3] = 5;
  out.camera.orthographic_height_m = 8;
  out.show = Show::colour;
  out.outline = Outline{1, {}, {1, 0, 0}};
  return out;
}

TEST_F(OutlineTest, ALineGoesAroundWhatIsSelected) {
  const DeviceScene scene = put(squares_side_by_side());
  Frame frame = from_the_front();
  const image::Image8 picture = draw(scene, frame);
  const std::array<uint8_t, 3> white{255, 255, 255}, red{255, 0, 0}, black{0, 0, 0};
  // The small square covers the pixels from 75 to 85 and from 35 to 45; the large one ends at 80.
  EXPECT_EQ(pixel(picture, 85, 40), red) << "right of it";
  EXPECT_EQ(pixel(picture, 84, 40), white) << "itself";
  EXPECT_EQ(pixel(picture, 88, 40), black);
  EXPECT_EQ(pixel(picture, 74, 40), red) << "where it is not seen, too";
  EXPECT_EQ(pixel(picture, 71, 40), white);
  EXPECT_EQ(pixel(picture, 80, 34), red);
  EXPECT_EQ(pixel(picture, 80, 45), red);
  EXPECT_EQ(pixel(picture, 80, 40), white);
  frame.outline->materials = {1};  // its right half
  const image::Image8 half = draw(scene, frame);
  EXPECT_EQ(pixel(half, 74, 40), white);
  EXPECT_EQ(pixel(half, 79, 40), red);
  frame.outline.reset();
  EXPECT_EQ(pixel(draw(scene, frame), 85, 40), black);
}

TEST_F(OutlineTest, WhatIsChangedLooksAsIfItHadBeenSo) {
  scene::Scene scene = scene::cornell_box();
  DeviceScene changed = put(scene);
  Frame frame;
  frame.camera = scene.cameras[0];
  const image::Image8 before = draw(changed, frame);
  for (const Show show : {Show::colour, Show::light_and_colour}) {
    frame.show = show;
    scene.instances[0].world_from_object =
        translation({0.05f, 0, 0}) * scene.instances[0].world_from_object * scaling({-1, 1, 1});
    scene.instances[1].world_from_object = translation({0, 0.1f, 0});
    scene.materials[0].base_color = {0.1f, 0.6f, 0.2f};
    scene.materials[1].emission = {0.5f, 0.1f, 0};
    scene.materials[2].metallic = 0.5f;
    for (const uint32_t i : {0u, 1u})
      set_transform(i, scene.instances[i].world_from_object, changed);
    set_base_color(0, scene.materials[0].base_color, changed);
    set_emission(1, scene.materials[1].emission, changed);
    set_metallic(2, scene.materials[2].metallic, changed);
    const image::Image8 now = draw(changed, frame);
    EXPECT_NE(now.data, before.data);
    EXPECT_EQ(now.data, draw(put(scene), frame).data);
  }
}

}  // namespace
}  // namespace luxel::view
