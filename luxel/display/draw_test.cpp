#include "luxel/display/draw.h"

#include <gtest/gtest.h>

#include <cstring>

#include "luxel/base/parallel.h"

namespace luxel::display {
namespace {

/// Adds the square of side 2 around `centre`, spanned by half axes x and y; its front is x cross y.
void add_square(scene::Scene& scene, Vec3 centre, Vec3 x, Vec3 y, const scene::Material& material) {
  scene::Mesh mesh;
  mesh.positions = {centre - x - y, centre + x - y, centre + x + y, centre - x + y};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.triangle_material.assign(2, uint32_t(scene.materials.size()));
  scene.materials.push_back(material);
  scene.instances.push_back({"square", uint32_t(scene.meshes.size()), {}});
  scene.meshes.push_back(mesh);
}

scene::Material gray(float rho) {
  scene::Material material;
  material.base_color = {rho, rho, rho};
  return material;
}

/// Looks from +z towards the origin.
scene::Camera camera_on_z(float z) {
  scene::Camera camera;
  camera.world_from_camera = translation({0, 0, z});
  return camera;
}

Rgb unit_irradiance(const scene::SurfacePoint&) { return {1, 1, 1}; }

image::Image draw_ok(const scene::Scene& scene, const scene::Camera& camera,
                     const DrawParams& params, const IrradianceAt& irradiance = unit_irradiance) {
  const auto tracer = trace::RayTracer::build(scene);
  EXPECT_TRUE(tracer);
  Progress progress;
  const auto picture = draw(scene, *tracer, camera, irradiance, params, progress);
  EXPECT_TRUE(picture);
  return *picture;
}

TEST(Draw, PlaneUnderUnitIrradianceHasRadianceRhoOverPi) {
  scene::Scene scene;
  add_square(scene, {}, {10, 0, 0}, {0, 10, 0}, gray(0.5f));
  const image::Image picture = draw_ok(scene, camera_on_z(2), {50, 37, 3});
  for (int y = 0; y < 37; ++y)
    for (int x = 0; x < 50; ++x) {
      EXPECT_FLOAT_EQ(picture.rgb(x, y).x, 0.5f / kPi);
      EXPECT_FLOAT_EQ(picture.rgb(x, y).z, 0.5f / kPi);
      EXPECT_EQ(picture.at(x, y)[3], 1);
    }
}

TEST(Draw, EmissionAddsToReflection) {
  scene::Scene scene;
  scene::Material lamp = gray(0.5f);
  lamp.emission = {3, 2, 1};
  add_square(scene, {}, {10, 0, 0}, {0, 10, 0}, lamp);
  const image::Image picture = draw_ok(scene, camera_on_z(2), {4, 4, 1});
  EXPECT_FLOAT_EQ(picture.rgb(2, 2).x, 3 + 0.5f / kPi);
  EXPECT_FLOAT_EQ(picture.rgb(2, 2).z, 1 + 0.5f / kPi);
}

TEST(Draw, UnlitSurfacesShowTheirColor) {
  scene::Scene scene;
  scene::Material sign = gray(0.5f);
  sign.unlit = true;
  sign.base_color = {1, 0.5f, 0.25f};
  sign.emission = {3, 2, 1};
  add_square(scene, {}, {10, 0, 0}, {0, 10, 0}, sign);
  EXPECT_EQ(draw_ok(scene, camera_on_z(2), {4, 4, 1}).rgb(2, 2), sign.base_color);
}

TEST(Draw, BackFacesOfOneSidedMaterialsAreInvisible) {
  // Forty-one squares turned away from the camera stand before the one that faces it.
  scene::Scene scene;
  add_square(scene, {}, {10, 0, 0}, {0, 10, 0}, gray(0.5f));
  for (int i = 0; i < 41; ++i)
    add_square(scene, {0, 0, 0.5f + 0.02f * float(i)}, {-10, 0, 0}, {0, 10, 0}, gray(0.1f));
  const image::Image picture = draw_ok(scene, camera_on_z(2), {8, 8, 2});
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 8; ++x) EXPECT_FLOAT_EQ(picture.rgb(x, y).y, 0.5f / kPi);
}

TEST(Draw, BackFacesAreSeenOnDemand) {
  scene::Scene scene;
  add_square(scene, {}, {10, 0, 0}, {0, -10, 0}, gray(0.5f));
  DrawParams params{8, 8, 1};
  EXPECT_EQ(draw_ok(scene, camera_on_z(5), params).at(4, 4)[3], 0);
  params.backs = true;
  EXPECT_EQ(draw_ok(scene, camera_on_z(5), params).at(4, 4)[3], 1);
}

TEST(Draw, BackFacesOfDoubleSidedMaterialsAreSeen) {
  scene::Scene scene;
  add_square(scene, {}, {10, 0, 0}, {0, 10, 0}, gray(0.5f));
  scene::Material both = gray(0.25f);
  both.double_sided = true;
  add_square(scene, {0, 0, 1}, {-10, 0, 0}, {0, 10, 0}, both);
  EXPECT_FLOAT_EQ(draw_ok(scene, camera_on_z(2), {8, 8, 2}).rgb(3, 3).y, 0.25f / kPi);
}

TEST(Draw, MirroredInstanceKeepsItsFront) {
  scene::Scene scene;
  add_square(scene, {}, {10, 0, 0}, {0, 10, 0}, gray(0.5f));
  scene.instances[0].world_from_object = scaling({-1, 1, 1});
  EXPECT_FLOAT_EQ(draw_ok(scene, camera_on_z(2), {4, 4, 1}).rgb(1, 1).x, 0.5f / kPi);
}

scene::Material pane(float rho, float alpha) {
  scene::Material material = gray(rho);
  material.alpha_mode = scene::AlphaMode::blend, material.alpha = alpha;
  return material;
}

// The nearer pane covers a half, the farther one a quarter of what is left, the wall all. A
// pane that turns its back is not there.
TEST(Draw, BlendedSurfacesCoverTheirShare) {
  scene::Scene scene;
  add_square(scene, {0, 0, 1}, {10, 0, 0}, {0, 10, 0}, pane(0.8f, 0.25f));
  add_square(scene, {0, 0, 1.5f}, {10, 0, 0}, {0, 10, 0}, pane(0.2f, 0.5f));
  add_square(scene, {0, 0, 1.2f}, {-10, 0, 0}, {0, 10, 0}, pane(0.9f, 0.5f));
  scene.background = {0.1f, 0.2f, 0.3f};
  const float panes = (0.5f * 0.2f + 0.5f * 0.25f * 0.8f) / kPi, left = 0.5f * 0.75f;
  const auto expect_everywhere = [&](Rgb behind, float covered) {
    const image::Image picture = draw_ok(scene, camera_on_z(2), {50, 37, 2});
    for (int y = 0; y < 37; ++y)
      for (int x = 0; x < 50; ++x) {
        EXPECT_LE(length(picture.rgb(x, y) - (Rgb{panes, panes, panes} + behind * left)), 1e-6f);
        EXPECT_FLOAT_EQ(picture.at(x, y)[3], covered);
      }
  };
  expect_everywhere(scene.background, 1 - left);
  add_square(scene, {}, {10, 0, 0}, {0, 10, 0}, gray(0.5f));
  expect_everywhere(Rgb{0.5f, 0.5f, 0.5f} * (1 / kPi), 1);
}

TEST(Draw, MissesShowTheBackground) {
  scene::Scene scene;
  add_square(scene, {0, 0, 5}, {1, 0, 0}, {0, 1, 0}, gray(0.5f));
  scene.background = {0.1f, 0.2f, 0.3f};
  const image::Image picture = draw_ok(scene, camera_on_z(2), {4, 4, 2});
  EXPECT_EQ(picture.rgb(2, 1), scene.background);
  EXPECT_EQ(picture.at(2, 1)[3], 0);
  EXPECT_EQ(draw_ok(scene, camera_on_z(2), {4, 4, 2, 0.25f}).rgb(2, 1), (Rgb{0.1f, 0.2f, 0.25f}));
}

TEST(Draw, PerspectiveAndOrthographicEdgesLieWhereGeometrySaysSo) {
  // The square's half side is 1. Seen from 2 m with tan(fov/2) = 1 it fills half the height;
  // orthographically with a height of 3 m it fills two thirds.
  scene::Scene scene;
  add_square(scene, {}, {1, 0, 0}, {0, 1, 0}, gray(0.5f));
  const auto covered = [&](const scene::Camera& camera, int width, int height) {
    const image::Image picture = draw_ok(scene, camera, {width, height, 2});
    double sum = 0;
    for (int i = 0; i < width * height; ++i) sum += double(picture.data[size_t(4 * i + 3)]);
    return sum;
  };
  scene::Camera camera = camera_on_z(2);
  camera.fov_y_rad = kPi / 2;
  EXPECT_EQ(covered(camera, 120, 60), 30 * 30);
  camera.aspect = 4;  // wider than the picture: the camera's full width must be seen
  EXPECT_EQ(covered(camera, 120, 60), 15 * 15);
  camera.aspect = 0;
  camera.orthographic_height_m = 3;
  EXPECT_EQ(covered(camera, 60, 60), 40 * 40);
}

TEST(Draw, ARodThinnerThanAPixelIsSeenAlongItsWholeLength) {
  // It is 1/3 pixel wide, 80 pixels long and rises by one pixel in 16: rays through the middles of
  // pixels meet it in five columns of 16. It differs in colour from a wall, or in A alone from
  // black surroundings.
  for (const bool before_wall : {true, false}) {
    scene::Scene scene;
    const Vec3 along = {40, 2.5f, 0};
    const Vec3 aside = normalize(Vec3{-along.y, along.x, 0}) * (1.0f / 6);
    add_square(scene, {}, along, aside, gray(before_wall ? 0.5f : 0));
    if (before_wall) add_square(scene, {0, 0, -1}, {60, 0, 0}, {0, 60, 0}, gray(0.25f));
    scene::Camera camera = camera_on_z(2);
    camera.orthographic_height_m = 60;
    const image::Image picture = draw_ok(scene, camera, {100, 60, 3});
    for (int x = 11; x < 89; ++x) {
      float seen = 0;
      for (int y = 0; y < 60; ++y)
        seen += before_wall ? 4 * kPi * picture.rgb(x, y).y - 1 : picture.at(x, y)[3];
      EXPECT_NEAR(seen, 1.0f / 3, 1.0f / 9 + 1e-4f) << x;
    }
  }
}

TEST(Draw, TopOfThePictureIsUp) {
  scene::Scene scene;
  add_square(scene, {}, {10, 0, 0}, {0, 10, 0}, gray(0.5f));
  const auto height = [&](const scene::SurfacePoint& p) {
    const Vec3 at = world_position(scene, p);
    return Rgb{at.x + 10, at.y + 10, 0};
  };
  const image::Image picture = draw_ok(scene, camera_on_z(2), {9, 9, 1}, height);
  EXPECT_GT(picture.rgb(4, 0).y, picture.rgb(4, 8).y);
  EXPECT_GT(picture.rgb(8, 4).x, picture.rgb(0, 4).x);
}

TEST(Draw, SameBitsForAnyThreadCount) {
  scene::Scene scene;
  add_square(scene, {}, {1, 0, 0}, {0, 1, 0.3f}, gray(0.5f));
  const auto irradiance = [&](const scene::SurfacePoint& p) { return Rgb{p.at.u, p.at.v, 1}; };
  image::Image one, seven;
  {
    const ThreadLimit limit(1);
    one = draw_ok(scene, camera_on_z(2), {70, 50, 3}, irradiance);
  }
  {
    const ThreadLimit limit(7);
    seven = draw_ok(scene, camera_on_z(2), {70, 50, 3}, irradiance);
  }
  EXPECT_EQ(std::memcmp(one.data.data(), seven.data.data(), one.data.size() * sizeof(float)), 0);
}

TEST(Draw, StopsWhenCancelled) {
  scene::Scene scene;
  add_square(scene, {}, {1, 0, 0}, {0, 1, 0}, gray(0.5f));
  const auto tracer = trace::RayTracer::build(scene);
  Progress progress;
  progress.request_cancel();
  const auto picture =
      draw(scene, *tracer, camera_on_z(2), unit_irradiance, DrawParams{}, progress);
  ASSERT_FALSE(picture);
  EXPECT_EQ(picture.error().code, ErrorCode::cancelled);
}

}  // namespace
}  // namespace luxel::display
