// A graphics device draws surfaces whose look is known without it. Skipped without a device.
#include <gmock/gmock.h>

#include <random>

#include "luxel/display/draw.h"
#include "luxel/display/smooth_lookup.h"
#include "luxel/image/color.h"
#include "luxel/image/false_color.h"
#include "luxel/image/flip.h"
#include "luxel/trace/camera_rays.h"
#include "luxel/trace/ray_tracer.h"
#include "luxel/view/draw/beside.h"
#include "luxel/view/draw/device_test_support.h"
#include "luxel/view/draw/put_layers.h"

namespace luxel::view {
namespace {

constexpr uint32_t kSide = 64;

/// A square from (-1, -1, 0) to (1, 1, 0) whose front looks along +z, lit evenly: E = 3.
struct LitSquare {
  scene::Scene scene;
  pipeline::LightmapPages lightmaps;

  LitSquare() {
    scene::Mesh mesh;
    mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
    mesh.uv1 = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    mesh.triangle_material = {0, 0};
    scene.meshes.push_back(mesh);
    scene.instances.push_back({});
    scene.materials.push_back({});
    scene.materials[0].base_color = {0.5f, 0.25f, 0.125f};
    image::Image light(2, 2, 4);
    for (int i = 0; i < 4; ++i) light.set_rgb(i % 2, i / 2, {3, 3, 3});
    lightmaps.pictures.push_back(light);
    lightmaps.of_material.assign(2, 0);
  }
};

/// From z = 3 towards the square; behind it where `from` is -3.
scene::Camera camera_at(float from) {
  scene::Camera camera;
  camera.world_from_camera.row[2][3] = from;
  if (from < 0) camera.world_from_camera.row[0][0] = camera.world_from_camera.row[2][2] = -1;
  return camera;
}

class PainterTest : public testing::OnDevice {
 protected:
  /// The radiance of a picture of kSide x kSide pixels.
  image::Image picture_of(const LitSquare& lit, const Frame& frame) {
    const auto scene = put_on_device(*commands_, lit.scene, lit.lightmaps);
    if (!scene) ADD_FAILURE() << scene.error().message;
    const auto painter = make_painter(*device_, *shaders_, *scene, kSide, kSide);
    if (!painter) ADD_FAILURE() << painter.error().message;
    auto picture = painted_radiance(*commands_, {*shaders_, *painter, *scene}, frame);
    if (!picture) ADD_FAILURE() << picture.error().message;
    return std::move(*picture);
  }
  Rgb middle_of(const LitSquare& lit, const Frame& frame) {
    return picture_of(lit, frame).rgb(kSide / 2, kSide / 2);
  }
};

/// Halves have 11 bits.
void expect_radiance(Rgb a, Rgb b) {
  EXPECT_LE(max_component(max(a - b, b - a)), max_component(b) * 2e-3f + 1e-6f)
      << a.x << " " << a.y << " " << a.z << " for " << b.x << " " << b.y << " " << b.z;
}

TEST_F(PainterTest, SurfacesSendReflectedAndEmittedLight) {
  LitSquare lit;
  lit.scene.materials[0].emission = {0, 0, 7};
  Frame frame;
  frame.camera = camera_at(3);
  const Rgb reflected = lit.scene.materials[0].base_color * (3 / kPi);
  for (const float exposure : {1.0f, 1e-4f, 100.0f}) {
    frame.exposure = exposure;
    expect_radiance(middle_of(lit, frame), reflected + Rgb{0, 0, 7});
  }
  frame.exposure = 1, frame.show = Show::light;
  expect_radiance(middle_of(lit, frame), Rgb{3, 3, 3} * (1 / kPi));
  frame.show = Show::colour;
  expect_radiance(middle_of(lit, frame), lit.scene.materials[0].base_color);
  frame.show = Show::light_and_colour;
  lit.scene.materials[0].unlit = true;
  expect_radiance(middle_of(lit, frame), lit.scene.materials[0].base_color);
}

// Light that changes: a part of what was there and the rest of what comes, each with a scale of its
// own, which halves have where the brightest differs.
TEST_F(PainterTest, LightFadesIntoItsSecondPicture) {
  const LitSquare lit;
  DeviceSceneParams params;
  params.light_changes = true;
  auto scene = put_on_device(*commands_, lit.scene, lit.lightmaps, params);
  ASSERT_TRUE(scene) << scene.error().message;
  image::Image bright(2, 2, 4);
  for (int i = 0; i < 4; ++i) bright.set_rgb(i % 2, i / 2, {5000, 3, 0});
  const std::vector<image::HalfImage> pages{image::to_half(bright)};
  ASSERT_TRUE(put_light(*commands_, pages, 1, *scene));
  const auto painter = make_painter(*device_, *shaders_, *scene, kSide, kSide);
  ASSERT_TRUE(painter) << painter.error().message;
  Frame frame;
  frame.camera = camera_at(3), frame.show = Show::light;
  for (const float share : {0.0f, 0.25f, 1.0f}) {
    scene->second_light = share;
    const auto picture = painted_radiance(*commands_, {*shaders_, *painter, *scene}, frame);
    ASSERT_TRUE(picture) << picture.error().message;
    expect_radiance(picture->rgb(kSide / 2, kSide / 2),
                    (Rgb{3, 3, 3} * (1 - share) + Rgb{5000, 3, 0} * share) * (1 / kPi));
  }
}

// Between texels light is that of display::smooth_lightmap_at(), which pictures of bakes have: the
// spline inside of a chart, bilinear beside the column that is not.
TEST_F(PainterTest, LightIsThatOfSmoothLookUps) {
  LitSquare lit;
  image::Image& light = lit.lightmaps.pictures[0];
  light = image::Image(12, 12, 4);
  std::mt19937 random(7);
  for (int i = 0; i < 144; ++i) {
    const float e = float(random() % 8);
    light.set_rgb(i % 12, i / 12, {e, 7 - e, 1});
    light.at(i % 12, i / 12)[3] = i % 12 == 8 ? 0.5f : 1.0f;
  }
  Frame frame;
  frame.camera = camera_at(3), frame.show = Show::light;
  const image::Image picture = picture_of(lit, frame);
  const auto tracer = trace::RayTracer::build(lit.scene);
  ASSERT_TRUE(tracer);
  const trace::CameraRays rays(frame.camera, kSide, kSide);
  for (const int y : {20, 29, 33, 41})
    for (int x = 14; x < 50; ++x) {
      const trace::Hit hit = tracer->closest_hit(rays.through(float(x) + 0.5f, float(y) + 0.5f));
      const bool is_on_diagonal = x + y == int(kSide) - 1;  // looked up twice, beside the middle
      if (!hit.found() || is_on_diagonal) continue;
      const Rgb e = display::smooth_lightmap_at(lit.scene, light, hit.point());
      const Rgb seen = picture.rgb(x, y) * kPi;
      EXPECT_LE(max_component(max(e - seen, seen - e)), 0.06f) << x << " " << y;
    }
}

// Metal reflects nothing diffusely, and no surface reflects more than 0.99.
TEST_F(PainterTest, ReflectanceIsThatOfTheSolvers) {
  LitSquare lit;
  Frame frame;
  frame.camera = camera_at(3);
  lit.scene.materials[0].base_color = {1, 1, 1};
  expect_radiance(middle_of(lit, frame), Rgb{3, 3, 3} * (scene::kMaxReflectance / kPi));
  lit.scene.materials[0].metallic = 0.75f;
  expect_radiance(middle_of(lit, frame), Rgb{3, 3, 3} * (0.25f / kPi));
}

TEST_F(PainterTest, BackFacesOfOneSidedMaterialsAreLeftOut) {
  for (const bool is_mirrored : {false, true})
    for (const bool is_double_sided : {false, true}) {
      LitSquare lit;
      lit.scene.background = {9, 9, 9};
      lit.scene.materials[0].double_sided = is_double_sided;
      // x turned round: the front still looks along +z.
      if (is_mirrored) lit.scene.instances[0].world_from_object.row[0][0] = -1;
      const Rgb seen = lit.scene.materials[0].base_color * (3 / kPi);
      Frame frame;
      frame.camera = camera_at(3);
      expect_radiance(middle_of(lit, frame), seen);
      frame.camera = camera_at(-3);
      expect_radiance(middle_of(lit, frame), is_double_sided ? seen : Rgb{9, 9, 9});
    }
}

TEST_F(PainterTest, HolesOfMasksShowWhatIsBehind) {
  LitSquare lit;
  lit.scene.background = {9, 9, 9};
  lit.scene.materials[0].alpha = 0.4f;
  Frame frame;
  frame.camera = camera_at(3);
  expect_radiance(middle_of(lit, frame), lit.scene.materials[0].base_color * (3 / kPi));
  lit.scene.materials[0].alpha_mode = scene::AlphaMode::mask;
  expect_radiance(middle_of(lit, frame), {9, 9, 9});
  lit.scene.materials[0].alpha = 1;
  lit.scene.meshes[0].alphas.assign(lit.scene.meshes[0].positions.size(), 0.4f);
  expect_radiance(middle_of(lit, frame), {9, 9, 9});
  lit.scene.meshes[0].alphas.clear();
  lit.scene.materials[0].alpha_cutoff = 1;
  expect_radiance(middle_of(lit, frame), lit.scene.materials[0].base_color * (3 / kPi));
}

// Nearer than what stands before it, drawn first or last.
TEST_F(PainterTest, NearSurfacesHideFarOnes) {
  for (const float second_z : {-1.0f, 1.0f}) {
    LitSquare lit;
    lit.scene.materials.push_back(lit.scene.materials[0]);
    lit.scene.materials[1].base_color = {0, 0.5f, 0};
    lit.scene.meshes.push_back(lit.scene.meshes[0]);
    lit.scene.meshes[1].triangle_material = {1, 1};
    lit.scene.instances.push_back({});
    lit.scene.instances[1].mesh = 1;
    lit.scene.instances[1].world_from_object.row[2][3] = second_z;
    Frame frame;
    frame.camera = camera_at(3);
    const size_t nearer = second_z > 0 ? 1 : 0;
    expect_radiance(middle_of(lit, frame), lit.scene.materials[nearer].base_color * (3 / kPi));
  }
}

// The map is 1 towards +x, where the camera looks, and 0 elsewhere: the middle of the picture is
// lit.
TEST_F(PainterTest, TheSurroundingsStandWhereDisplayDrawsThem) {
  LitSquare lit;
  lit.scene.environment.width = 16, lit.scene.environment.height = 8;
  for (int i = 0; i < 128; ++i)
    lit.scene.environment.radiance.push_back({float(i % 16), float(i / 16), 1});
  lit.scene.environment.rotation_rad = 1;
  Frame frame;
  for (const float yaw : {0.0f, 2.0f, 4.0f}) {
    const float c = std::cos(yaw), s = std::sin(yaw);
    frame.camera.world_from_camera.row = {{{c, 0, s, 0}, {0, 1, 0, 5}, {-s, 0, c, 0}}};
    const image::Image picture = picture_of(lit, frame);
    const trace::CameraRays rays(frame.camera, kSide, kSide);
    for (const int at : {5, 20, 60}) {
      const Rgb wanted = scene::smooth_surroundings_towards(
          lit.scene, rays.through(float(at) + 0.5f, 30.5f).direction);
      // The device's own interpolation has 8 bits for the place between two pixels.
      EXPECT_LE(length(picture.rgb(at, 30) - wanted), 0.15f) << yaw << " " << at;
      EXPECT_EQ(picture.at(at, 30)[3], 0);
    }
  }
}

// Perspective and parallel cameras, turned, and narrower or wider than the picture.
TEST_F(PainterTest, CamerasSeeWhatDisplayDraws) {
  LitSquare lit;
  lit.scene.background = {0.1f, 0.1f, 0.1f};
  const auto tracer = trace::RayTracer::build(lit.scene);
  ASSERT_TRUE(tracer);
  Frame frame;
  frame.camera = camera_at(3);
  const float c = std::cos(0.3f), s = std::sin(0.3f);
  frame.camera.world_from_camera.row = {{{c, 0, s, 0.9f}, {0, 1, 0, 0.2f}, {-s, 0, c, 3}}};
  for (const auto& [aspect, height_m] : {std::pair(0.0f, 0.0f), {2.0f, 0.0f}, {0.0f, 3.0f}}) {
    frame.camera.aspect = aspect, frame.camera.orthographic_height_m = height_m;
    display::DrawParams size;
    size.width = size.height = kSide;
    Progress progress;
    const auto wanted = display::draw(
        lit.scene, *tracer, frame.camera,
        [](const scene::SurfacePoint&) {
          return Rgb{3, 3, 3};
        },
        size, progress);
    ASSERT_TRUE(wanted);
    const image::Image picture = picture_of(lit, frame);
    double off = 0;
    for (size_t i = 0; i < picture.data.size(); ++i)
      off += std::abs(picture.data[i] - wanted->data[i]);
    // Some 160 of 4096 pixels lie on the edge, whose shares of 4 and of 9 samples differ by 0.1.
    EXPECT_LT(off / double(picture.data.size()), 0.01) << aspect << " " << height_m;
  }
}

// A lamp that is seen and the surroundings shine as their layers do, and so does the lightmap.
TEST_F(PainterTest, LayersDimWhatIsSeenOfThem) {
  LitSquare lit;
  lit.scene.materials[0].emission = {1, 1, 1};
  lit.scene.background = {4, 4, 4};
  Layers layers;
  layers.layers.resize(2);
  layers.layers[0].name = "lamp", layers.layers[1].name = "sky";
  layers.layers[1].has_surroundings = true;
  image::Image light(2, 2, 4);
  for (int i = 0; i < 4; ++i) light.set_rgb(i % 2, i / 2, {1, 1, 1});
  layers.layers[0].pages = {light};
  for (int i = 0; i < 4; ++i) light.set_rgb(i % 2, i / 2, {2, 2, 2});
  layers.layers[1].pages = {light};
  layers.shines_in = {0};
  DeviceSceneParams params;
  params.light_changes = true;
  auto scene = put_on_device(*commands_, lit.scene, lit.lightmaps, params);
  ASSERT_TRUE(scene) << scene.error().message;
  const auto painter = make_painter(*device_, *shaders_, *scene, kSide, kSide);
  ASSERT_TRUE(painter) << painter.error().message;
  Frame frame;
  const Rgb lamp{0.5f, 1, 0}, sky{2, 0, 1};
  for (const bool is_set : {true, false}) {  // and back to what was baked
    if (is_set) frame.layers = {{"lamp", 0.5f, {1, 2, 0}}, {"sky", 1, sky}};
    if (!is_set) frame.layers.clear();
    const auto mixed = mixed_light(layers, frame.layers, lit.lightmaps);
    ASSERT_TRUE(mixed) << mixed.error().message;
    ASSERT_TRUE(put_layers(*commands_, layers, frame.layers, *mixed, is_set, *scene));
    const Rgb one{1, 1, 1}, by_lamp = is_set ? lamp : one, by_sky = is_set ? sky : one;
    const auto middle = [&](float from) {
      frame.camera = camera_at(from);
      const auto picture = painted_radiance(*commands_, {*shaders_, *painter, *scene}, frame);
      return picture ? picture->rgb(kSide / 2, kSide / 2) : Rgb{};
    };
    const Rgb e = by_lamp + by_sky * 2;
    expect_radiance(middle(3), lit.scene.materials[0].base_color * e * (1 / kPi) + by_lamp);
    expect_radiance(middle(-3), by_sky * 4);  // the square has no back
  }
}

// E of 3 beside E of 2.8: left and right of the line, and 0.069 of their mean apart.
TEST_F(PainterTest, TwoBakesAreShownBesideOneAnother) {
  LitSquare lit, darker;
  for (int i = 0; i < 4; ++i)
    darker.lightmaps.pictures[0].set_rgb(i % 2, i / 2, {2.8f, 2.8f, 2.8f});
  const auto scene = put_on_device(*commands_, lit.scene, lit.lightmaps);
  const auto other = put_on_device(*commands_, darker.scene, darker.lightmaps);
  ASSERT_TRUE(scene && other);
  const auto painter = make_painter(*device_, *shaders_, *scene, kSide, kSide);
  ASSERT_TRUE(painter) << painter.error().message;
  const auto pair = make_pair(*commands_, *shaders_, *painter, *other);
  ASSERT_TRUE(pair) << pair.error().message;
  const Canvas first{*shaders_, *painter, *scene}, second{*shaders_, pair->second, *other};
  Frame frame;
  frame.camera = camera_at(3), frame.camera.fov_y_rad = 0.4f;  // the square fills the picture
  const auto a = painted(*commands_, first, frame), b = painted(*commands_, second, frame);
  ASSERT_TRUE(a && b);
  frame.beside.emplace();
  const auto together = [&](BesideMode mode, int x) {
    frame.beside->mode = mode, frame.beside->split = 0.25f;
    const auto picture = painted_together(*commands_, first, second, *pair, frame);
    if (!picture) ADD_FAILURE() << picture.error().message;
    const size_t i = 3 * size_t(kSide / 2 * kSide + uint32_t(x));
    return std::vector<uint8_t>(picture->data.begin() + std::ptrdiff_t(i),
                                picture->data.begin() + std::ptrdiff_t(i + 3));
  };
  const auto pixel = [](const image::Image8& picture) {
    const auto i = std::ptrdiff_t(3 * (kSide / 2 * kSide + kSide / 2));
    return std::vector<uint8_t>(picture.data.begin() + i, picture.data.begin() + i + 3);
  };
  EXPECT_NE(pixel(*a), pixel(*b));
  EXPECT_EQ(together(BesideMode::split, 5), pixel(*a));
  EXPECT_EQ(together(BesideMode::split, 20), pixel(*b));
  EXPECT_EQ(together(BesideMode::split, 16), (std::vector<uint8_t>{255, 255, 255})) << "the line";
  const image::Color8 wanted = image::false_color(double(0.2f / 2.9f / kMostDifference));
  const std::vector<uint8_t> seen = together(BesideMode::difference, 40);
  for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(seen[c], wanted[c], 5);
  // FLIP of two even pictures is even, and as CPU's FLIP has it.
  image::Image left(16, 16, 3), right(16, 16, 3);
  for (size_t i = 0; i < left.data.size(); ++i) {
    left.data[i] = image::linear_from_srgb(float(pixel(*a)[i % 3]) / 255);
    right.data[i] = image::linear_from_srgb(float(pixel(*b)[i % 3]) / 255);
  }
  const image::Color8 flip = image::false_color(double(image::flip(left, right).data[100]));
  const std::vector<uint8_t> flip_seen = together(BesideMode::flip, 40);
  for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(flip_seen[c], flip[c], 2);
  const auto mean = compare(*commands_, *painter, *pair);
  ASSERT_TRUE(mean);
  EXPECT_NEAR(*mean, image::flip(left, right).data[100], 2e-3f);
}

}  // namespace
}  // namespace luxel::view
