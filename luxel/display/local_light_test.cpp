// Closed forms at points whose vectors are known.
#include "luxel/display/local_light.h"

#include <gtest/gtest.h>

#include <array>

namespace luxel::display {
namespace {

using enum LocalTechnique;
constexpr std::array kAll{c, ca, cad, cas, cads, cas_pixel, cads_pixel};

const LocalSurface kPaint{{0.5f, 0.4f, 0.2f}, {0.3f, 0.2f, 0.1f}, 10};
const LocalLights kFromAbove{{0.1f, 0.2f, 0.3f}, {0.8f, 0.7f, 0.6f}, {0, 0, -1}};
constexpr Vec3 kUp{0, 0, 1};

void expect_color(Rgb a, Rgb b) {
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(a[k], b[k], 1e-6f) << "channel " << k;
}

TEST(LocalColor, FacingTheLightAndTheViewerEveryTermIsFull) {
  const Rgb ambient = kFromAbove.ambient * kPaint.material;
  const Rgb diffuse = kFromAbove.light * kPaint.material;
  const Rgb specular = kFromAbove.light * kPaint.specular;
  const auto color = [](LocalTechnique t) { return local_color(t, kPaint, kFromAbove, kUp, kUp); };
  expect_color(color(c), kPaint.material);
  expect_color(color(ca), ambient);
  expect_color(color(cad), ambient + diffuse);
  expect_color(color(cas), ambient + specular);
  expect_color(color(cads), ambient + diffuse + specular);
  expect_color(color(cas_pixel), color(cas));
  expect_color(color(cads_pixel), color(cads));
}

TEST(LocalColor, DiffuseLightFollowsTheCosine) {
  const Vec3 n{std::sqrt(3.0f) / 2, 0, 0.5f};  // 60 degrees
  const Rgb ambient = kFromAbove.ambient * kPaint.material;
  expect_color(local_color(cad, kPaint, kFromAbove, n, kUp),
               ambient + kFromAbove.light * kPaint.material * 0.5f);
}

// Light from the upper left: the highlight stands where a mirror would send it, on the right. The
// print's formula would put it back at the lamp.
TEST(LocalColor, TheHighlightStandsWhereAMirrorSendsTheLight) {
  LocalLights lights = kFromAbove;
  lights.direction = normalize(Vec3{1, 0, -1});
  const Rgb ambient = lights.ambient * kPaint.material;
  const Vec3 mirror = normalize(Vec3{1, 0, 1}), lamp = normalize(Vec3{-1, 0, 1});
  expect_color(local_color(cas, kPaint, lights, kUp, mirror),
               ambient + lights.light * kPaint.specular);
  expect_color(local_color(cas, kPaint, lights, kUp, lamp), ambient);
  // 60 degrees beside it: cos^10 = 2^-10.
  const Vec3 aside = mirror * 0.5f + Vec3{0, 1, 0} * (std::sqrt(3.0f) / 2);
  expect_color(local_color(cas, kPaint, lights, kUp, aside),
               ambient + lights.light * kPaint.specular * (1.0f / 1024));
}

TEST(LocalColor, WhatIsTurnedAwayHasOnlyAmbientLight) {
  for (const Vec3 viewer : {Vec3{0, 0, 1}, Vec3{0, 0, -1}, normalize(Vec3{1, 0, -1})})
    for (const LocalTechnique t : {cad, cas, cads})
      expect_color(local_color(t, kPaint, kFromAbove, -kUp, viewer),
                   kFromAbove.ambient * kPaint.material);
}

TEST(LocalColor, SumsAreClippedAtWhite) {
  const LocalLights bright{{1, 1, 1}, {1, 1, 1}, {0, 0, -1}};
  const LocalSurface white{{1, 0.9f, 0.1f}, {1, 0, 0.3f}, 1};
  expect_color(local_color(cads, white, bright, kUp, kUp), {1, 1, 0.5f});
}

/// An equilateral triangle around the origin, its corners at distance 1, seen from z = 1.
struct Stage {
  scene::Scene scene;
  scene::Camera camera;
  Stage() {
    scene::Mesh mesh;
    for (int i = 0; i < 3; ++i) {
      const float angle = 2 * kPi * float(i) / 3;
      mesh.positions.push_back({std::cos(angle), std::sin(angle), 0});
    }
    mesh.triangles = {{0, 1, 2}};
    mesh.triangle_material = {0};
    scene::Material paint;
    paint.base_color = kPaint.material, paint.specular = kPaint.specular, paint.sharpness = 10;
    scene.materials = {paint};
    scene.meshes = {mesh};
    scene.instances = {{"it", 0, {}}};
    camera.world_from_camera = translation({0, 0, 1});
  }
  Rgb at(LocalTechnique t, Barycentric where, bool back = false) const {
    const trace::Hit hit{1, 0, 0, where, back};
    return local_light_at(scene, hit, t, kFromAbove, Viewer(camera));
  }
};

// In the middle V = R. At the corners they are 45 degrees apart: cos^10 = 1/32.
TEST(LocalLight, PerVertexMissesTheHighlightInATrianglesMiddle) {
  const Stage stage;
  const Rgb ambient = kFromAbove.ambient * kPaint.material;
  const Rgb full = kFromAbove.light * kPaint.specular;
  const Barycentric middle{1.0f / 3, 1.0f / 3};
  expect_color(stage.at(cas, middle), ambient + full * (1.0f / 32));
  expect_color(stage.at(cas_pixel, middle), ambient + full);
  for (const Barycentric corner : {Barycentric{0, 0}, Barycentric{1, 0}, Barycentric{0, 1}})
    expect_color(stage.at(cas, corner), stage.at(cas_pixel, corner));
  const Rgb diffuse = kFromAbove.light * kPaint.material;
  expect_color(stage.at(cads_pixel, middle) - stage.at(cads, middle), full * (31.0f / 32));
  expect_color(stage.at(cads_pixel, middle) - stage.at(cas_pixel, middle), diffuse);
}

// Normals that lean outwards by 60 degrees: a corner gets half of the light, the middle, where
// their sum stands upright, all of it.
TEST(LocalLight, InterpolatedNormalsAreMadeUnitAgain) {
  Stage stage;
  for (const Vec3& p : stage.scene.meshes[0].positions)
    stage.scene.meshes[0].normals.push_back(normalize(p * std::sqrt(3.0f) + Vec3{0, 0, 1}));
  stage.scene.materials[0].specular = {};
  const Barycentric middle{1.0f / 3, 1.0f / 3};
  const Rgb ambient = kFromAbove.ambient * kPaint.material;
  const Rgb diffuse = kFromAbove.light * kPaint.material;
  expect_color(stage.at(cads, middle), ambient + diffuse * 0.5f);
  expect_color(stage.at(cads_pixel, middle), ambient + diffuse);
}

TEST(LocalLight, ATransformMovesNormalsAndCorners) {
  Stage stage;
  // Turned by 60 degrees about y and put elsewhere; seen from along its normal.
  const float s = std::sqrt(3.0f) / 2;
  const Vec3 place{5, 6, 7}, normal{s, 0, 0.5f};
  stage.scene.instances[0].world_from_object =
      from_columns({0.5f, 0, -s}, {0, 1, 0}, normal, place);
  stage.camera.world_from_camera = from_columns({0.5f, 0, -s}, {0, 1, 0}, normal, place + normal);
  const Barycentric middle{1.0f / 3, 1.0f / 3};
  expect_color(stage.at(cad, middle),
               kFromAbove.ambient * kPaint.material + kFromAbove.light * kPaint.material * 0.5f);
  // R and V are 60 degrees apart.
  expect_color(stage.at(cas_pixel, middle), kFromAbove.ambient * kPaint.material +
                                                kFromAbove.light * kPaint.specular * (1.0f / 1024));
}

TEST(LocalLight, TheBackOfASheetIsLitAsAFront) {
  const Stage stage;
  const Barycentric middle{1.0f / 3, 1.0f / 3};
  expect_color(stage.at(cad, middle, true), kFromAbove.ambient * kPaint.material);
}

TEST(LocalLight, AnOrthographicViewerLooksAlongOneDirection) {
  Stage stage;
  stage.camera.orthographic_height_m = 2;
  for (const Barycentric where : {Barycentric{0, 0}, Barycentric{0.7f, 0.1f}})
    expect_color(stage.at(cas, where),
                 kFromAbove.ambient * kPaint.material + kFromAbove.light * kPaint.specular);
}

TEST(LocalLight, VertexColoursAndWeirdMaterialsStayOnTheScreen) {
  Stage stage;
  stage.scene.meshes[0].colors = {{2, 0, 0}, {0, 2, 0}, {0, 0, 2}};
  stage.scene.materials[0].base_color = {5, 5, 5};
  stage.scene.materials[0].sharpness = 1e6f;
  stage.camera.world_from_camera = translation({1, 0, 0});  // the eye in a corner
  for (const LocalTechnique t : kAll)
    for (const Barycentric where : {Barycentric{0, 0}, Barycentric{0.3f, 0.3f}}) {
      const Rgb color = stage.at(t, where);
      EXPECT_TRUE(is_finite(color));
      EXPECT_GE(min_component(color), 0);
      EXPECT_LE(max_component(color), 1);
    }
}

TEST(LocalLights, TheScenesFirstSunGivesTheDirection) {
  Stage stage;
  const Vec3 from_camera = local_lights(stage.scene, stage.camera).direction;
  EXPECT_NEAR(length(from_camera), 1, 1e-6f);
  EXPECT_GT(from_camera.x, 0) << "from the left";
  EXPECT_LT(from_camera.y, 0) << "from above";
  EXPECT_LT(from_camera.z, 0) << "from behind the viewer";
  stage.scene.lights.push_back({});
  stage.scene.lights.push_back({});
  stage.scene.lights[1].kind = scene::PunctualLight::Kind::directional;
  stage.scene.lights[1].direction = {0, 0, 2};
  EXPECT_EQ(local_lights(stage.scene, stage.camera).direction, (Vec3{0, 0, 1}));
}

}  // namespace
}  // namespace luxel::display
