#include "luxel/pipeline/texels/wrong_sides.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

#include "luxel/scene/shapes.h"

namespace luxel::pipeline {
namespace {

/// Mesh and instance of the plate that is looked at.
constexpr uint32_t kPlate = 0;

/// A mesh's x and z as its TEXCOORD_1, `scale` of it to a metre.
void give_uv1(scene::Mesh& mesh, float scale) {
  for (const Vec3& p : mesh.positions) mesh.uv1.push_back({0.5f + scale * p.x, 0.5f + scale * p.z});
}

/// A double-sided plate of 1 x 1 m in the dark, its front up.
scene::Scene plate_in_the_dark() {
  scene::Scene s;
  scene::add_material(s, "plate", {0.5f, 0.5f, 0.5f});
  s.materials[0].double_sided = true;
  scene::add_rectangle(s, {-0.5f, 0.5f, -0.5f, 0.5f}, 0, true, 0);
  give_uv1(s.meshes[kPlate], 0.25f);
  return s;
}

void add_lamp(scene::Scene& s, float y, float intensity) {
  s.lights.emplace_back();
  s.lights.back().position = {0, y, 0};
  s.lights.back().intensity = {intensity, intensity, intensity};
}

WrongSides wrong_in(const scene::Scene& s, LightIs light_is = LightIs::known) {
  Progress progress;
  std::vector<std::vector<uint8_t>> open(s.meshes.size());
  open[kPlate].assign(s.meshes[kPlate].triangles.size(), 1);
  const auto wrong = wrong_sides(s, open, light_is, progress);
  EXPECT_TRUE(wrong);
  EXPECT_LE(wrong->shown, wrong->all);
  return *wrong;
}

TEST(WrongSides, SidesInTheSameLightMayShareAPlace) {
  scene::Scene s = plate_in_the_dark();
  s.background = {1, 2, 3};
  EXPECT_EQ(wrong_in(s).all, 0);
  EXPECT_EQ(wrong_in(s, LightIs::to_come).all, 1);  // what comes may be another light
}

TEST(WrongSides, SidesInTheDarkMayShareAPlace) { EXPECT_EQ(wrong_in(plate_in_the_dark()).all, 0); }

// By symmetry the light from below is everywhere the same share of that from above.
TEST(WrongSides, AQuarterOfTheLightIsTheLimit) {
  for (const auto& [below, wrong] : {std::pair{1.0f, 0}, {0.8f, 0}, {0.7f, 1}, {0.0f, 1}}) {
    for (const float side : {1.0f, -1.0f}) {
      scene::Scene s = plate_in_the_dark();
      add_lamp(s, side, 10), add_lamp(s, -side, 10 * below);
      EXPECT_EQ(wrong_in(s).all, wrong) << below;
    }
  }
}

// A floor of 16 m^2, which has as much of TEXCOORD_1 as the plate of 1 m^2: half of (1/17 + 1/2).
TEST(WrongSides, TheShareIsThatOfSurfaceAndCoordinates) {
  scene::Scene s = plate_in_the_dark();
  add_lamp(s, 1, 10);
  scene::add_rectangle(s, {8, 12, -2, 2}, -0.1f, true, 0);
  give_uv1(s.meshes[1], 0.0625f);
  EXPECT_NEAR(wrong_in(s).all, 0.5 * (1.0 / 17 + 1.0 / 2), 1e-6);
}

// A place a hundredth as bright as the scene's mean is dark on both sides.
TEST(WrongSides, WhatIsDarkBesideTheSceneIsNotLookedAt) {
  scene::Scene s = plate_in_the_dark();
  add_lamp(s, 1, 1);
  scene::add_rectangle(s, {18, 22, -2, 2}, -0.1f, true, 0);
  give_uv1(s.meshes[1], 0.0625f);
  EXPECT_GT(wrong_in(s).all, 0.2);
  s.lights.push_back(s.lights[0]);
  s.lights[1].position = {20, 1, 0};
  s.lights[1].intensity = {1000, 1000, 1000};
  EXPECT_EQ(wrong_in(s).all, 0);
}

// Over a floor the underside of a table shows; that of the floor itself, beneath which nobody can
// stand, does not. The table has 1 of 37 m^2 and a tenth of TEXCOORD_1.
TEST(WrongSides, OnlyWhatIsSeenFromAFloorShows) {
  scene::Scene s = plate_in_the_dark();
  s.background = {1, 1, 1};
  add_lamp(s, 1, 10);
  EXPECT_EQ(wrong_in(s).all, 1);
  EXPECT_EQ(wrong_in(s).shown, 0);  // the plate is the ground, with nothing else in the world
  scene::add_rectangle(s, {-3, 3, -3, 3}, -0.7f, true, 0);
  give_uv1(s.meshes[1], 0.125f);
  const WrongSides table = wrong_in(s);
  EXPECT_NEAR(table.all, 0.5 * (1.0 / 37 + 1.0 / 10), 1e-6);
  EXPECT_GE(table.shown, 0.95 * table.all);
}

/// A box of one-sided walls below the plate, which is its lid.
void add_box_below(scene::Scene& s) {
  const uint32_t solid = scene::add_material(s, "solid", {0.5f, 0.5f, 0.5f});
  scene::Mesh box;
  scene::add_box(box, {-0.5f, -1, -0.5f}, {0.5f, 0, 0.5f}, solid);
  std::erase_if(box.triangles, [&](const auto& t) {
    return std::ranges::all_of(t, [&](uint32_t v) { return box.positions[v].y == 0; });
  });
  box.triangle_material.resize(box.triangles.size());
  give_uv1(box, 0.25f);
  scene::place(s, std::move(box));
}

TEST(WrongSides, ABackWithinASolidIsNotSeenAndAFrontMayBeThere) {
  for (const bool front_within : {false, true}) {
    scene::Scene s = plate_in_the_dark();
    s.background = {1, 1, 1};
    add_box_below(s);
    if (front_within)
      for (auto& [a, b, c] : s.meshes[kPlate].triangles) std::swap(b, c);
    EXPECT_EQ(wrong_in(s).shown > 0.1, front_within);
    EXPECT_EQ(wrong_in(s, LightIs::to_come).shown > 0.1, front_within);
  }
}

// The underside of a ground does not show where something stands on it and its front is black.
TEST(WrongSides, TheGroundBeneathASolidDoesNotShow) {
  scene::Scene s = plate_in_the_dark();
  s.background = {1, 1, 1};
  const uint32_t solid = scene::add_material(s, "solid", {0.5f, 0.5f, 0.5f});
  scene::Mesh box;
  scene::add_box(box, {-0.4f, 0, -0.4f}, {0.4f, 1, 0.4f}, solid);
  give_uv1(box, 0.25f);
  scene::place(s, std::move(box));
  EXPECT_GT(wrong_in(s).all, 0.1);
  EXPECT_EQ(wrong_in(s).shown, 0);
}

}  // namespace
}  // namespace luxel::pipeline
