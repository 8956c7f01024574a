// Shapes among surfaces.
#include <cmath>

#include "luxel/scene/shapes.h"
#include "luxel/trace/camera_rays.h"
#include "luxel/view/draw/device_test_support.h"

namespace luxel::view {
namespace {

constexpr int kWallPixels = 60;

/// A black wall at z = -2, seen by a camera at the origin that looks along -z; a pixel is a
/// thirtieth of a metre there.
scene::Scene black_wall() {
  scene::Scene scene;
  const uint32_t black = scene::add_material(scene, "black", {0, 0, 0});
  scene::Mesh mesh;
  scene::add_triangle(mesh, {-1, -1, -2}, {1, -1, -2}, {1, 1, -2}, black);
  scene::add_triangle(mesh, {-1, -1, -2}, {1, 1, -2}, {-1, 1, -2}, black);
  scene::place(scene, std::move(mesh));
  scene.cameras.push_back({});
  scene.cameras[0].fov_y_rad = 2 * std::atan(0.5f);
  return scene;
}

class ShapesTest : public testing::OnDevice {
 protected:
  image::Image8 picture_of(const Shapes& shapes, Frame frame = {}) {
    const scene::Scene scene = black_wall();
    pipeline::LightmapPages black;
    black.pictures.emplace_back(1, 1, 4);
    black.of_material.assign(scene.materials.size(), 0);
    const auto on_device = put_on_device(*commands_, scene, black);
    EXPECT_TRUE(on_device) << on_device.error().message;
    const auto painter = make_painter(*device_, *shaders_, *on_device, kWallPixels, kWallPixels);
    EXPECT_TRUE(painter) << painter.error().message;
    Additions additions;
    auto put = put_shapes(*device_, shapes);
    EXPECT_TRUE(put) << put.error().message;
    additions.shapes.push_back(std::move(*put));
    frame.camera = scene.cameras[0];
    const auto out =
        painted(*commands_, {*shaders_, *painter, *on_device, nullptr, &additions}, frame);
    EXPECT_TRUE(out) << out.error().message;
    return out ? *out
               : image::Image8{kWallPixels, kWallPixels, 3,
                               std::vector<uint8_t>(3 * kWallPixels * kWallPixels)};
  }
};

std::array<int, 3> wall_pixel(const image::Image8& picture, size_t x, size_t y) {
  const uint8_t* p = picture.data.data() + 3 * (kWallPixels * y + x);
  return {p[0], p[1], p[2]};
}

int level(float display) { return int(std::lround(255 * display)); }

/// Number of pixels that are not black.
size_t count_seen(const image::Image8& picture) {
  size_t out = 0;
  for (size_t i = 0; i < picture.data.size(); i += 3)
    out += picture.data[i] + picture.data[i + 1] + picture.data[i + 2] > 0;
  return out;
}

// Lines of 4 pixels' width on the wall and behind it, one that begins behind the camera, a disc and
// a triangle.
TEST_F(ShapesTest, LieWhereTheyAreAndAreHidden) {
  Shapes shapes;
  const float depth = -2;
  shapes.line_width = 4, shapes.disc_width = 10;
  // Row 15 is half a metre above the middle of the wall.
  shapes.lines = {{{-0.5f, 0.5f, depth}, {0, 1, 0}}, {{0.5f, 0.5f, depth}, {0, 1, 0}}};
  shapes.discs = {{{0, -0.5f, depth}, {1, 0, 0}}};
  shapes.triangles = {{{-0.9f, -0.1f, depth}, {0, 0, 1}},
                      {{-0.5f, -0.1f, depth}, {0, 0, 1}},
                      {{-0.5f, 0.1f, depth}, {0, 0, 1}}};
  const image::Image8 seen = picture_of(shapes);
  for (const size_t x : {16, 30, 43}) {
    EXPECT_GT(wall_pixel(seen, x, 14)[1], 200) << x;
    EXPECT_EQ(wall_pixel(seen, x, 11), (std::array{0, 0, 0})) << x;
    EXPECT_EQ(wall_pixel(seen, x, 18), (std::array{0, 0, 0})) << x;
  }
  EXPECT_EQ(wall_pixel(seen, 12, 15), (std::array{0, 0, 0})) << "beyond its end";
  EXPECT_GT(wall_pixel(seen, 30, 45)[0], 200);
  EXPECT_EQ(wall_pixel(seen, 30, 52), (std::array{0, 0, 0})) << "beyond the disc";
  EXPECT_EQ(wall_pixel(seen, 25, 40), (std::array{0, 0, 0})) << "the disc is round";
  EXPECT_GT(wall_pixel(seen, 14, 29)[2], 200);
  EXPECT_EQ(wall_pixel(seen, 6, 28), (std::array{0, 0, 0})) << "above the triangle's slope";
  // 30 * 4 + pi 25 + 36, to within their borders.
  EXPECT_NEAR(double(count_seen(seen)), 120 + 79 + 36, 50);
  // A tenth of a metre behind the wall; and nevertheless.
  for (auto* corners : {&shapes.lines, &shapes.discs, &shapes.triangles})
    for (ShapeCorner& corner : *corners) corner.place = corner.place * 1.05f;
  EXPECT_EQ(count_seen(picture_of(shapes)), 0u);
  shapes.is_hidden = false;
  EXPECT_NEAR(double(count_seen(picture_of(shapes))), double(count_seen(seen)), 10);
}

TEST_F(ShapesTest, LinesThatBeginBehindTheCameraAreCut) {
  Shapes shapes;
  shapes.line_width = 2;
  // From above the eye and behind it down to the middle of the wall, through the upper half.
  shapes.lines = {{{0, 3, 4}, {1, 1, 1}}, {{0, 0, -2}, {1, 1, 1}}};
  const image::Image8 seen = picture_of(shapes);
  for (size_t y = 0; y < 30; ++y)
    EXPECT_GT(wall_pixel(seen, 29, y)[0] + wall_pixel(seen, 30, y)[0], 200);
  for (size_t y = 32; y < 60; ++y) EXPECT_EQ(wall_pixel(seen, 30, y)[0], 0) << y;
  // From pixel (45, 45) to the border at (60, 37.5): a strip of 16.8 by 6 pixels, and those that
  // its border covers in part.
  shapes.line_width = 6;
  shapes.lines = {{{3, 3, 4}, {1, 1, 1}}, {{0.5f, -0.5f, -2}, {1, 1, 1}}};
  EXPECT_NEAR(double(count_seen(picture_of(shapes))), 101 + 2 * 16.8, 8);
}

// A screen shows the colour that was asked for, whatever curve and exposure light has.
TEST_F(ShapesTest, HaveTheColoursThatAreAskedFor) {
  for (const Rgb color : {Rgb{0.2f, 0.2f, 0.2f}, Rgb{0.55f, 0.1f, 0.85f}, Rgb{0.1f, 0.7f, 0.2f},
                          Rgb{0.5f, 0.1f, 0.1f}, Rgb{0.9f, 0.9f, 0.9f}}) {
    Shapes shapes;
    for (const Vec2 at :
         {Vec2{-1, -1}, Vec2{1, -1}, Vec2{1, 1}, Vec2{-1, -1}, Vec2{1, 1}, Vec2{-1, 1}})
      shapes.triangles.push_back({{at.x, at.y, -1.9f}, color});
    for (const Show show : {Show::light_and_colour, Show::colour}) {
      Frame frame;
      frame.exposure = 7, frame.show = show;
      const std::array<int, 3> seen = wall_pixel(picture_of(shapes, frame), 30, 30);
      EXPECT_NEAR(seen[0], level(color.x), 3) << color.x << ' ' << color.y << ' ' << int(show);
      EXPECT_NEAR(seen[1], level(color.y), 3) << color.x << ' ' << color.y << ' ' << int(show);
      EXPECT_NEAR(seen[2], level(color.z), 3) << color.x << ' ' << color.y << ' ' << int(show);
    }
  }
}

}  // namespace
}  // namespace luxel::view
