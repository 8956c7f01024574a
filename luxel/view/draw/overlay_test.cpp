// Looks into a bake whose texels, charts and values are known. Skipped without a device.
#include "luxel/view/draw/overlay.h"

#include <gmock/gmock.h>

#include <random>

#include "luxel/display/lightmap_lookup.h"
#include "luxel/image/color.h"
#include "luxel/image/false_color.h"
#include "luxel/trace/camera_rays.h"
#include "luxel/trace/ray_tracer.h"
#include "luxel/view/draw/device_test_support.h"

namespace luxel::view {
namespace {

using Shown8 = image::Color8;

constexpr int kPixels = 128;

/// A square from (-1, -1, 0) to (1, 1, 0) whose front looks along +z, on all of a lightmap. Its
/// left and its right half are charts of their own where `is_cut`.
struct LookedAt {
  scene::Scene scene;
  pipeline::LightmapPages lightmaps;

  explicit LookedAt(int texels, bool is_cut = false) {
    scene::Mesh mesh;
    for (const float x : {-1.0f, 0.0f, 0.0f, 1.0f})
      for (const float y : {1.0f, -1.0f}) {
        mesh.positions.push_back({x, y, 0});
        mesh.uv1.push_back({(1 + x) / 2, (1 - y) / 2});
      }
    if (is_cut)
      for (size_t i = 4; i < 8; ++i) mesh.uv1[i].x += 1e-4f;
    mesh.triangles = {{0, 1, 3}, {0, 3, 2}, {4, 5, 7}, {4, 7, 6}};
    mesh.triangle_material.assign(4, 0);
    scene.meshes.push_back(mesh);
    scene.instances.push_back({});
    scene.materials.push_back({});
    lightmaps.pictures.emplace_back(texels, texels, 4);
    for (float& v : lightmaps.pictures[0].data) v = 1;
    lightmaps.of_material.assign(2, 0);
  }
};

/// So near that the square fills the picture, from the side where `yaw_rad` is not 0.
scene::Camera before_the_square(float yaw_rad = 0) {
  scene::Camera camera;
  const float c = std::cos(yaw_rad), s = std::sin(yaw_rad);
  camera.world_from_camera.row = {{{c, 0, s, 3 * s}, {0, 1, 0, 0}, {-s, 0, c, 3 * c}}};
  camera.fov_y_rad = 2 * std::atan(1 / 3.0f);
  return camera;
}

class OverlayTest : public testing::OnDevice {
 protected:
  image::Image8 picture_of(const LookedAt& at, const Frame& frame, const Look& look) {
    const auto scene = put_on_device(*commands_, at.scene, at.lightmaps);
    if (!scene) ADD_FAILURE() << scene.error().message;
    const auto overlay =
        make_overlay(*commands_, shaders_->overlay, at.scene, at.lightmaps, look, *scene);
    if (!overlay) ADD_FAILURE() << overlay.error().message;
    const auto painter = make_painter(*device_, *shaders_, *scene, kPixels, kPixels);
    if (!painter) ADD_FAILURE() << painter.error().message;
    auto picture = painted(*commands_, {*shaders_, *painter, *scene, &*overlay}, frame);
    if (!picture) ADD_FAILURE() << picture.error().message;
    return std::move(*picture);
  }
  image::Image8 picture_of(const LookedAt& at, const Frame& frame) {
    return picture_of(at, frame, look_at(at.scene, at.lightmaps));
  }
};

Shown8 pixel_of(const image::Image8& picture, int x, int y) {
  const size_t i = 3 * (size_t(y) * size_t(picture.width) + size_t(x));
  return {picture.data[i], picture.data[i + 1], picture.data[i + 2]};
}

int apart(Shown8 a, Shown8 b) {
  int out = 0;
  for (size_t c = 0; c < 3; ++c) out = std::max(out, std::abs(int(a[c]) - int(b[c])));
  return out;
}

float channel_of(Rgb e, Channel channel) {
  return channel == Channel::luminance ? luminance(e) : e[int(channel)];
}

/// Noise in every texel, seen from the side: what the processor looks up at each pixel's middle.
TEST_F(OverlayTest, IrradianceHasTheFalseColourOfItsValue) {
  LookedAt at(8);
  std::mt19937 random(3);
  std::uniform_real_distribution<float> noise(1, 900);
  for (int i = 0; i < 64; ++i)
    at.lightmaps.pictures[0].set_rgb(i % 8, i / 8, {noise(random), noise(random), noise(random)});
  const auto tracer = trace::RayTracer::build(at.scene);
  ASSERT_TRUE(tracer);
  Frame frame;
  frame.camera = before_the_square(0.6f);
  frame.show = Show::irradiance, frame.exposure = 17;
  for (const ColorScale scale : {ColorScale{0, 800, false}, {100, 500, false}, {10, 1000, true}})
    for (const Channel channel : {Channel::red, Channel::blue, Channel::luminance}) {
      frame.irradiance = scale, frame.channel = channel;
      const image::Image8 picture = picture_of(at, frame);
      const trace::CameraRays rays(frame.camera, kPixels, kPixels);
      int off = 0;
      for (const auto& [x, y] : {std::pair(64, 64), {40, 30}, {90, 100}, {64, 20}, {30, 80}}) {
        std::array ray{rays.through(float(x) + 0.5f, float(y) + 0.5f)};
        const trace::Hit hit = trace::visible_hits(at.scene, *tracer, ray).front();
        ASSERT_TRUE(hit.found());
        const Rgb e = display::lightmap_at(at.scene, at.lightmaps.pictures[0], hit.point());
        const double value = double(channel_of(e, channel));
        const double t = scale.is_logarithmic
                             ? std::log(value / scale.low) / std::log(scale.high / scale.low)
                             : (value - scale.low) / (scale.high - scale.low);
        off = std::max(off, apart(pixel_of(picture, x, y), image::false_color(t)));
      }
      // Two of the table's 256 steps: the device's interpolation has 8 bits.
      EXPECT_LE(off, 8) << scale.low << " " << kChannels[size_t(channel)];
    }
}

// The scale that no frame gives is the bake's: its top is a round number over the light.
TEST_F(OverlayTest, ScalesAreThoseOfTheBake) {
  LookedAt at(4);
  for (float& v : at.lightmaps.pictures[0].data) v = 490;
  Frame frame;
  frame.camera = before_the_square();
  frame.show = Show::irradiance;
  const Look look = look_at(at.scene, at.lightmaps);
  EXPECT_EQ(look.irradiance, (ColorScale{0, 500, false}));
  EXPECT_LE(apart(pixel_of(picture_of(at, frame, look), 64, 50), image::false_color(0.98)), 4);
}

/// Changes of tone along a row of the picture.
int changes_in_row(const image::Image8& picture, int y) {
  int out = 0;
  for (int x = 1; x < picture.width; ++x)
    out += (pixel_of(picture, x, y)[0] < 100) != (pixel_of(picture, x - 1, y)[0] < 100);
  return out;
}

TEST_F(OverlayTest, TheCheckerHasASquareForEachTexel) {
  for (const int texels : {4, 8, 16}) {
    const LookedAt at(texels);
    Frame frame;
    frame.camera = before_the_square();
    frame.show = Show::checker, frame.curve = display::ToneMap::clamp;
    frame.exposure = kPi * 0.2f;  // E is 1: 0.2 in light squares, 0.09 in dark ones
    const image::Image8 picture = picture_of(at, frame);
    const int half = kPixels / texels / 2;
    EXPECT_EQ(changes_in_row(picture, half), texels - 1);
    const int light = int(std::lround(255 * image::srgb_from_linear(0.2f)));
    const int dark = int(std::lround(255 * image::srgb_from_linear(0.09f)));
    EXPECT_NEAR(pixel_of(picture, half, half)[0], light, 1) << "the texel at u = v = 0";
    EXPECT_NEAR(pixel_of(picture, 3 * half, half)[0], dark, 1);
    EXPECT_NEAR(pixel_of(picture, half, 3 * half)[0], dark, 1);
    EXPECT_NEAR(pixel_of(picture, 3 * half, 3 * half)[0], light, 1);
  }
  // Squares far finer than pixels are even.
  Frame frame;
  frame.camera = before_the_square();
  frame.show = Show::checker, frame.curve = display::ToneMap::clamp, frame.exposure = kPi * 0.2f;
  const image::Image8 even = picture_of(LookedAt(1024), frame);
  const float mean = 0.2f * (1 + 0.45f) / 2;
  for (int x = 2; x < kPixels; x += 7)
    EXPECT_NEAR(pixel_of(even, x, 33)[0], 255 * image::srgb_from_linear(mean), 8);
}

TEST_F(OverlayTest, DensityIsTexelsPerMetre) {
  for (const float size : {1.0f, 0.5f})
    for (const float yaw_rad : {0.0f, 0.7f}) {
      LookedAt at(64);  // 2 m
      at.scene.instances[0].world_from_object = scaling({size, size, size});
      Frame frame;
      frame.camera = before_the_square(yaw_rad);
      frame.show = Show::density;
      frame.density = {4, 256, true};
      const double t = std::log(32 / size / 4) / std::log(64.0);
      const Shown8 wanted = image::false_color(t), seen = pixel_of(picture_of(at, frame), 64, 60);
      // Faces that turn away are darker, in linear light.
      const float shade = 0.7f + 0.3f * std::cos(yaw_rad);
      for (size_t c = 0; c < 3; ++c) {
        const float linear = image::linear_from_srgb(float(wanted[c]) / 255) * shade;
        EXPECT_NEAR(seen[c], 255 * image::srgb_from_linear(linear), 4) << size << " " << yaw_rad;
      }
    }
}

TEST_F(OverlayTest, ChartsHaveColoursAndSeamsLines) {
  for (const bool is_cut : {false, true}) {
    const LookedAt at(16, is_cut);
    Frame frame;
    frame.camera = before_the_square();
    frame.show = Show::charts;
    const image::Image8 charts = picture_of(at, frame);
    EXPECT_EQ(apart(pixel_of(charts, 10, 10), pixel_of(charts, 30, 100)), 0) << "of one chart";
    EXPECT_EQ(apart(pixel_of(charts, 10, 10), pixel_of(charts, 100, 10)) > 50, is_cut);
    frame.show = Show::seams;
    const image::Image8 seams = picture_of(at, frame);
    const Shown8 surface = pixel_of(seams, 20, 90);
    for (const int x : {0, 30, 60, 67, 100, 127}) EXPECT_EQ(pixel_of(seams, x, 40), surface) << x;
    for (const int x : {63, 64}) EXPECT_EQ(apart(pixel_of(seams, x, 40), surface) > 50, is_cut);
  }
}

/// A picture of the folder has its own colours on surfaces that face the viewer.
TEST_F(OverlayTest, TexelsHaveTheColoursOfTheirPictures) {
  const LookedAt at(4);
  Look look = look_at(at.scene, at.lightmaps);
  image::Image8 picture{4, 4, 4, {}};
  std::mt19937 random(5);
  for (int i = 0; i < 64; ++i) picture.data.push_back(uint8_t(random()));
  for (const Show show : {Show::texels, Show::error}) {
    look.texels.clear(), look.errors.clear();
    (show == Show::texels ? look.texels : look.errors).push_back(picture);
    Frame frame;
    frame.camera = before_the_square();
    frame.show = show;
    const image::Image8 shown = picture_of(at, frame, look);
    for (int i = 0; i < 16; ++i) {
      const uint8_t* texel = picture.data.data() + 4 * i;
      const Shown8 seen = pixel_of(shown, i % 4 * 32 + 13, i / 4 * 32 + 20);
      EXPECT_LE(apart(seen, {texel[0], texel[1], texel[2]}), 1) << i;
    }
  }
}

TEST_F(OverlayTest, OverlapsAreRed) {
  LookedAt at(8);
  // The right half lies over the left one, but for its last quarter.
  for (size_t i = 4; i < 8; ++i) at.scene.meshes[0].uv1[i].x -= 0.25f;
  Frame frame;
  frame.camera = before_the_square();
  frame.show = Show::overlaps;
  const image::Image8 shown = picture_of(at, frame);
  const auto is_red = [&](int x) {
    const Shown8 c = pixel_of(shown, x, 41);
    return int(c[0]) > 2 * int(c[1]);
  };
  EXPECT_FALSE(is_red(16));
  EXPECT_TRUE(is_red(48));
  EXPECT_TRUE(is_red(80));
  EXPECT_FALSE(is_red(112));
}

// Mirrored and double-sided surfaces, and holes: as in pictures of light.
TEST_F(OverlayTest, LeavesOutWhatPicturesOfLightLeaveOut) {
  for (const bool is_mirrored : {false, true})
    for (const bool is_double_sided : {false, true}) {
      LookedAt at(4);
      at.scene.materials[0].double_sided = is_double_sided;
      if (is_mirrored) at.scene.instances[0].world_from_object.row[0][0] = -1;
      Frame frame;
      frame.show = Show::charts;
      const Shown8 behind{232, 232, 232};
      frame.camera = before_the_square();
      EXPECT_NE(pixel_of(picture_of(at, frame), 50, 50), behind);
      frame.camera = before_the_square(kPi);
      EXPECT_EQ(pixel_of(picture_of(at, frame), 50, 50) == behind, !is_double_sided);
      frame.camera = before_the_square();
      at.scene.materials[0].alpha = 0.4f;
      at.scene.materials[0].alpha_mode = scene::AlphaMode::mask;
      EXPECT_EQ(pixel_of(picture_of(at, frame), 50, 50), behind);
      at.scene.materials[0].alpha = 1;
      EXPECT_NE(pixel_of(picture_of(at, frame), 50, 50), behind);
      at.scene.meshes[0].alphas.assign(at.scene.meshes[0].positions.size(), 0.4f);
      EXPECT_EQ(pixel_of(picture_of(at, frame), 50, 50), behind);
    }
}

}  // namespace
}  // namespace luxel::view
