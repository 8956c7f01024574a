#include <gmock/gmock.h>

#include "luxel/image/color.h"
#include "luxel/pipeline/bake/bake_scene.h"
#include "luxel/scene/place_camera.h"
#include "luxel/scene/shapes.h"
#include "luxel/trace/camera_rays.h"

namespace luxel::pipeline {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

/// A bake in which the preview is what counts.
Bake quick_bake(scene::Scene scene, const OutsideLight& outside = {}) {
  BakeSettings settings;
  settings.resolution = 64, settings.samples = 64, settings.direct_samples = 4;
  settings.outside = outside;
  Progress progress;
  Result<Bake> bake = bake_scene(std::move(scene), settings, progress);
  EXPECT_TRUE(bake) << bake.error().message;
  return std::move(*bake);
}

std::array<int, 3> pixel(const Bake& bake, int x, int y) {
  const uint8_t* c =
      bake.preview.data.data() + 3 * (size_t(y) * size_t(bake.preview.width) + size_t(x));
  return {c[0], c[1], c[2]};
}

/// The pixel that shows a place.
std::array<int, 3> pixel_at(const Bake& bake, Vec3 place) {
  const Vec2 at =
      trace::CameraRays(bake.view.camera, bake.view.width, bake.view.height).pixel_of(place);
  return pixel(bake, int(at.x), int(at.y));
}

/// A square of 2 x 2 m on the ground.
scene::Scene plate(bool up, const scene::Material& material = {}) {
  scene::Scene scene;
  scene.materials.push_back(material);
  scene::add_rectangle(scene, {-1, 1, -1, 1}, 0, up, 0);
  scene.instances[0].name = "plate";
  return scene;
}

// The default camera cannot see a front. The stripes of the back are dark and bright greys, and the
// sky beside it is the day's.
TEST(Preview, ShowsFlippedFacesHatchedAndSaysSo) {
  const Bake bake = quick_bake(plate(false));
  EXPECT_THAT(bake.warnings, Contains(AllOf(HasSubstr("no front of a surface is in preview.png"),
                                            HasSubstr("faces of 'plate' flipped"))));
  int darkest = 255, brightest = 0;
  for (float x = -0.5f; x < 0.5f; x += 0.02f) {
    const auto [r, g, b] = pixel_at(bake, {x, 0, 0});
    EXPECT_TRUE(r == g && g == b);
    darkest = std::min(darkest, r), brightest = std::max(brightest, r);
  }
  EXPECT_GT(darkest, 40);
  EXPECT_GT(brightest, darkest + 20);
  const std::array<int, 3> sky = pixel(bake, 2, 2);
  EXPECT_LT(*std::ranges::max_element(sky), 250);
  EXPECT_GT(*std::ranges::min_element(sky), 60);
}

// Seen from outside, a box whose fronts look inwards shows insides that no light gets to.
TEST(Preview, ShowsABoxThatIsInsideOutHatched) {
  scene::Scene scene;
  scene::add_material(scene, "grey", {0.5f, 0.5f, 0.5f});
  scene::Mesh box;
  scene::add_box(box, {-1, 0, -1}, {1, 1, 1}, 0);
  for (auto& [a, b, c] : box.triangles) std::swap(b, c);
  scene::place(scene, std::move(box));
  EXPECT_THAT(quick_bake(std::move(scene)).warnings,
              Contains(HasSubstr("all fronts of surfaces are black in preview.png")));
}

TEST(Preview, ExposesForTheSkyWhereNothingIsSeen) {
  scene::Material gone;
  gone.name = "skin", gone.alpha = 0, gone.alpha_mode = scene::AlphaMode::blend;
  const Bake bake = quick_bake(plate(true, gone));
  EXPECT_THAT(bake.warnings, Contains(HasSubstr("preview.png shows no surface")));
  EXPECT_THAT(bake.warnings, Contains(HasSubstr("'skin' are fully transparent")));
  const std::array<int, 3> sky = pixel(bake, 2, 2);
  EXPECT_LT(*std::ranges::max_element(sky), 250);
}

// Where nothing is behind the surfaces, neutral grey is: 0.2 of the screen's light.
TEST(Preview, HasNoBlackVoid) {
  scene::Scene scene = plate(true);
  scene.lights.push_back({.name = "lamp", .intensity = {100, 100, 100}, .position = {0, 3, 0}});
  const auto grey = int(std::lround(255 * image::srgb_from_linear(0.2f)));
  EXPECT_THAT(pixel(quick_bake(std::move(scene)), 2, 2), ::testing::Each(grey));
}

scene::Scene box_of(Rgb color) {
  scene::Scene scene;
  scene::add_material(scene, "paint", color);
  scene::Mesh box;
  scene::add_box(box, {-0.5f, 0, -0.5f}, {0.5f, 1, 0.5f}, 0);
  scene::place(scene, std::move(box));
  return scene;
}

/// The brightest side that is in view.
std::array<int, 3> brightest_side(const Bake& bake) {
  const Vec3 eye = column(bake.view.camera.world_from_camera, 3);
  std::array<int, 3> best{};
  for (const Vec3 n : {Vec3{0, 1, 0}, {1, 0, 0}, {-1, 0, 0}, {0, 0, 1}, {0, 0, -1}}) {
    const Vec3 place = Vec3{0, 0.5f, 0} + n * 0.5f;
    if (dot(eye - place, n) <= 0) continue;
    const std::array<int, 3> side = pixel_at(bake, place);
    if (side[0] > best[0]) best = side;
  }
  return best;
}

// In a picture that is exposed for light, not for what comes back of it, each colour is itself.
TEST(Preview, ShowsDarkColoursDark) {
  const std::array<int, 3> brown =
      brightest_side(quick_bake(box_of({0.138684f, 0.048346f, 0.015263f})));
  EXPECT_NEAR(brown[0], 103, 8);
  EXPECT_NEAR(brown[1], 62, 8);
  EXPECT_NEAR(brown[2], 33, 8);
}

TEST(Preview, ShowsPureRedWithoutGreenOrBlue) {
  const std::array<int, 3> red = brightest_side(quick_bake(box_of({0.8f, 0, 0})));
  EXPECT_GT(red[0], 180);
  EXPECT_LE(red[1], 4);
  EXPECT_LE(red[2], 4);
}

// A camera that shows an even wall is what the user asked for; a sentence says what is seen.
TEST(Preview, SaysWhyAPictureIsOfOneColour) {
  scene::Scene scene = plate(true);
  scene.meshes[0].positions = {{-9, 0, -9}, {9, 0, -9}, {9, 0, 9}, {-9, 0, 9}};
  scene.meshes[0].triangles = {{0, 2, 1}, {0, 3, 2}};
  scene::place_camera(scene, "down", {0, 4, 0.1f}, {0, 0, 0}, 0.5f);
  OutsideLight even;
  even.background = Rgb{1, 1, 1};
  EXPECT_THAT(quick_bake(std::move(scene), even).warnings,
              Contains(HasSubstr("preview.png is one colour: its view shows one evenly lit")));
  EXPECT_THAT(quick_bake(box_of({0.5f, 0.5f, 0.5f})).warnings,
              Not(Contains(HasSubstr("preview.png"))));
}

}  // namespace
}  // namespace luxel::pipeline
