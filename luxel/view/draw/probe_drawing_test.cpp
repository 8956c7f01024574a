// Balls in the light of probes, against the processor's evaluation of the same harmonics.
#include "luxel/view/draw/probe_drawing.h"

#include <gmock/gmock.h>

#include "luxel/image/color.h"
#include "luxel/image/false_color.h"
#include "luxel/scene/procedural.h"
#include "luxel/trace/camera_rays.h"
#include "luxel/view/draw/device_test_support.h"

namespace luxel::view {
namespace {

constexpr int kBallPixels = 96;

/// Each function has its share, a channel its own; nowhere below 0 but at the bottom of blue.
light::Probe some_probe(Vec3 position) {
  light::Probe out{.position = position};
  for (size_t k = 0; k < kSh2; ++k)
    out.irradiance[k] = {0.1f * float(k) - 0.3f, 0.4f - 0.1f * float(k), k == 1 ? 2.0f : 0.1f};
  out.irradiance[0] = {8, 6, 3};
  return out;
}

/// A room without light, and a ball before its camera.
struct RoomWithBall {
  scene::Scene scene = scene::cornell_box();
  pipeline::LightmapPages black;
  ProbeBalls balls;
  Frame frame;
  RoomWithBall() {
    for (scene::Material& material : scene.materials) material.emission = {};
    black.pictures.emplace_back(1, 1, 4);
    black.of_material.assign(scene.materials.size(), 0);
    frame.camera = scene.cameras[0];
    frame.shows_probes = true;
    const trace::CameraRays rays(frame.camera, kBallPixels, kBallPixels);
    const float size = scene::world_bounds(scene).diagonal();
    balls.probes = {some_probe(rays.eye + normalize(rays.forward) * size)};
    balls.spacing_m = size;
  }
  /// Normal of the ball at a pixel; none beside it, or too near its edge.
  std::optional<Vec3> normal_at(int x, int y) const {
    const trace::Ray ray = trace::CameraRays(frame.camera, kBallPixels, kBallPixels)
                               .through(float(x) + 0.5f, float(y) + 0.5f);
    const Vec3 d = normalize(ray.direction), to = balls.probes[0].position - ray.origin;
    const float along = dot(to, d), radius = radius_of(balls);
    const float inside = radius * radius - (dot(to, to) - along * along);
    if (!(inside > 0.15f * radius * radius)) return std::nullopt;
    return normalize(d * (along - std::sqrt(inside)) - to);
  }
};

class ProbeDrawing : public testing::OnDevice {
 protected:
  image::Image radiance_of(const RoomWithBall& room) {
    const auto scene = put_on_device(*commands_, room.scene, room.black);
    const auto painter = make_painter(*device_, *shaders_, *scene, kBallPixels, kBallPixels);
    const auto probes = put_probes(*device_, room.balls);
    EXPECT_TRUE(scene && painter && probes);
    auto picture = painted_radiance(
        *commands_, {*shaders_, *painter, *scene, nullptr, nullptr, &*probes}, room.frame);
    EXPECT_TRUE(picture);
    return std::move(*picture);
  }
};

TEST_F(ProbeDrawing, ABallShowsTheLightThatItsSurfaceWouldGet) {
  RoomWithBall room;
  room.frame.exposure = 0.5f;
  const image::Image picture = radiance_of(room);
  int compared = 0;
  for (int y = 0; y < kBallPixels; ++y)
    for (int x = 0; x < kBallPixels; ++x) {
      const auto n = room.normal_at(x, y);
      if (!n) continue;
      const Rgb wanted = max(sh2_value(room.balls.probes[0].irradiance, *n), Rgb{}) * (1 / kPi);
      // The ball is one of flat parts: normals are off by a degree or two.
      EXPECT_LE(max_component(max(picture.rgb(x, y) - wanted, wanted - picture.rgb(x, y))), 0.03f)
          << x << " " << y;
      ++compared;
    }
  EXPECT_GT(compared, 300);
  room.frame.shows_probes = false;
  const image::Image without = radiance_of(room);
  EXPECT_EQ(max_component(without.rgb(kBallPixels / 2, kBallPixels / 2)), 0);
}

TEST_F(ProbeDrawing, WallsHideBalls) {
  RoomWithBall room;
  const trace::CameraRays rays(room.frame.camera, kBallPixels, kBallPixels);
  room.balls.probes[0].position = rays.eye + normalize(rays.forward) * 100;
  room.balls.spacing_m = 50;
  const image::Image picture = radiance_of(room);
  EXPECT_EQ(max_component(picture.rgb(kBallPixels / 2, kBallPixels / 2)), 0);
}

TEST_F(ProbeDrawing, ABallHasTheFalseColoursOfIrradiance) {
  RoomWithBall room;
  room.frame.show = Show::irradiance, room.frame.channel = Channel::red;
  room.frame.irradiance = {0, 4, false};
  const auto scene = put_on_device(*commands_, room.scene, room.black);
  const Look look = look_at(room.scene, room.black);
  const auto overlay =
      make_overlay(*commands_, shaders_->overlay, room.scene, room.black, look, *scene);
  ASSERT_TRUE(overlay) << overlay.error().message;
  const auto painter = make_painter(*device_, *shaders_, *scene, kBallPixels, kBallPixels);
  const auto probes = put_probes(*device_, room.balls);
  const auto picture =
      painted(*commands_, {*shaders_, *painter, *scene, &*overlay, nullptr, &*probes}, room.frame);
  ASSERT_TRUE(picture) << picture.error().message;
  for (const auto& [x, y] : {std::pair(48, 48), {44, 50}, {52, 43}}) {
    const auto n = room.normal_at(x, y);
    ASSERT_TRUE(n);
    const float e = sh2_value(room.balls.probes[0].irradiance, *n).x;
    const image::Color8 wanted = image::false_color(double(e / 4));
    for (size_t c = 0; c < 3; ++c)
      EXPECT_NEAR(picture->data[3 * size_t(kBallPixels * y + x) + c], wanted[c], 6) << x;
  }
}

}  // namespace
}  // namespace luxel::view
