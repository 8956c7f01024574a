#include "luxel/scene/light_profile.h"

#include <gtest/gtest.h>

#include "luxel/base/random.h"
#include "luxel/base/vec_double.h"
#include "luxel/base/warp.h"
#include "luxel/scene/scene.h"

namespace luxel::scene {
namespace {

using Angles = LightProfile::Angles;
constexpr Vec3 kAim{0, 0, -1}, kSide{1, 0, 0};
constexpr float kDegree = kPi / 180;

/// I0 cos(v) at every `step` degrees below, dark above: a plate that shines evenly.
LightProfile cosine_profile(float candela, int step) {
  LightProfile p;
  p.horizontal_rad = {0};
  for (int v = 0; v <= 90; v += step) {
    p.vertical_rad.push_back(float(v) * kDegree);
    p.candela.push_back(candela * std::max(0.0f, std::cos(float(v) * kDegree)));
  }
  return p;
}

/// Linear in both angles, so that bilinear interpolation of a coarse grid is exact.
LightProfile linear_profile(Angles angles) {
  const bool is_c = angles == Angles::c;
  LightProfile p;
  p.angles = angles;
  for (const float v : is_c ? std::vector<float>{0, 20, 90, 180} : std::vector<float>{-90, 10, 90})
    p.vertical_rad.push_back(v * kDegree);
  for (const float h : is_c ? std::vector<float>{0, 70, 360} : std::vector<float>{-90, 30, 90})
    p.horizontal_rad.push_back(h * kDegree);
  for (const float h : p.horizontal_rad)
    for (const float v : p.vertical_rad) p.candela.push_back(100 + 7 * v + 3 * h);
  return p;
}

/// The directions as light_profile.h has them.
DVec3 direction_of(Angles angles, double v, double h) {
  using std::cos, std::sin;
  if (angles == Angles::b) return {cos(h) * sin(v), -sin(h), -cos(h) * cos(v)};
  if (angles == Angles::a) return {sin(v), -cos(v) * sin(h), -cos(v) * cos(h)};
  return {sin(v) * cos(h), sin(v) * sin(h), -cos(v)};
}

TEST(LightProfile, AllKindsOfAnglesAreInverted) {
  for (const Angles angles : {Angles::c, Angles::b, Angles::a}) {
    const LightProfile p = linear_profile(angles);
    RandomStream random{5, 0};
    for (int i = 0; i < 200; ++i) {
      const Vec2 u = random.next2();
      const double v = angles == Angles::c ? double(u.x) * 3.1 + 0.02 : double(u.x) * 3 - 1.5;
      const double h = angles == Angles::c ? double(u.y) * 6.2 + 0.02 : double(u.y) * 3 - 1.5;
      const float got = candela_at(p, kAim, kSide, to_float(direction_of(angles, v, h)));
      // A float direction is off by 1e-7, near a pole, where its sine is 0.02, by 50 times that.
      EXPECT_NEAR(double(got), 100 + 7 * v + 3 * h, 1e-4) << int(angles) << " " << v << " " << h;
    }
  }
}

// Behind a floodlight no angle of its grid is, and above a lamp measured to 90 degrees neither.
TEST(LightProfile, BeyondItsAnglesItIsDark) {
  for (const Angles angles : {Angles::b, Angles::a})
    EXPECT_EQ(candela_at(linear_profile(angles), kAim, kSide, normalize(Vec3{0.3f, 0.2f, 1})), 0);
  const LightProfile half = cosine_profile(10, 10);
  EXPECT_EQ(candela_at(half, kAim, kSide, normalize(Vec3{1, 0, 0.01f})), 0);
  EXPECT_GT(candela_at(half, kAim, kSide, normalize(Vec3{1, 0, -0.01f})), 0);
}

// Linear interpolation is off by I h^2 / 8 at most, h being the step: 3.8e-5 at one degree.
TEST(LightProfile, BetweenItsAnglesItIsLinear) {
  const LightProfile p = cosine_profile(100, 1);
  for (float v = 0; v < 1.57f; v += 0.0137f)
    EXPECT_NEAR(candela_at(p, kAim, kSide, {std::sin(v), 0, -std::cos(v)}), 100 * std::cos(v),
                4e-3f);
}

// Four sides, told apart: 0 is the lamp's side, and 90 follows counter-clockwise seen from behind
// the lamp, from above for one that hangs.
TEST(LightProfile, TurnsWithTheLamp) {
  LightProfile p;
  p.vertical_rad = {0, kPi};
  for (const int h : {0, 90, 180, 270, 360}) {
    p.horizontal_rad.push_back(float(h) * kDegree);
    p.candela.insert(p.candela.end(), 2, float(h % 360));
  }
  const auto at = [&](Vec3 aim, Vec3 side, Vec3 d) { return candela_at(p, aim, side, d); };
  constexpr float kRounding = 1e-4f;
  EXPECT_NEAR(at(kAim, kSide, {1, 0, 0}), 0, kRounding);
  EXPECT_NEAR(at(kAim, kSide, {0, 1, 0}), 90, kRounding);
  EXPECT_NEAR(at(kAim, kSide, {-1, 0, 0}), 180, kRounding);
  EXPECT_NEAR(at(kAim, kSide, {0, -1, 0}), 270, kRounding);
  // Hanging, its side to the south (+z): east (+x) is a quarter further, seen from above.
  const Vec3 down{0, -1, 0}, south{0, 0, 1};
  EXPECT_NEAR(at(down, south, south), 0, kRounding);
  EXPECT_NEAR(at(down, south, {1, 0, 0}), 90, kRounding);
  EXPECT_NEAR(at(down, south, {-1, 0, 0}), 270, kRounding);
  // Between the last side and the first.
  EXPECT_NEAR(at(kAim, kSide, normalize(Vec3{1, -1, 0})), 135, kRounding);
}

// The flux of I0 cos(v) is pi I0; over a cone of half angle a its mean is I0 (1 + cos a) / 2.
// Linear interpolation loses h^2 / 12 of the cosine: 2.5e-5 at one degree; 512 steps lose less.
TEST(LightProfile, MeansAreThoseOfTheCosine) {
  const LightProfile p = cosine_profile(100, 1);
  EXPECT_NEAR(4 * kPiDouble * mean_candela(p, kPiDouble), 100 * kPiDouble, 100 * kPiDouble * 5e-5);
  for (const double a : {0.2, 1.0, 1.5})
    EXPECT_NEAR(mean_candela(p, a), 50 * (1 + std::cos(a)), 100 * 5e-5) << a;
}

TEST(LightProfile, AttachingKeepsTheColourAndStraightensTheFrame) {
  Scene scene;
  scene.lights.resize(3);
  scene.lights[0].intensity = {20, 10, 5}, scene.lights[0].direction = {0, -3, 0};
  scene.lights[0].side = {2, 5, 0};
  scene.lights[1].intensity = {}, scene.lights[1].direction = {0, 0, 1};
  scene.lights[1].side = {0, 0, 1};
  for (size_t i : {0, 1}) attach_profile(scene, i, cosine_profile(1, 45), 0.5f);
  EXPECT_EQ(scene.lights[0].intensity, (Rgb{0.5f, 0.25f, 0.125f}));
  EXPECT_EQ(scene.lights[1].intensity, (Rgb{0.5f, 0.5f, 0.5f}));
  EXPECT_EQ(scene.lights[0].direction, (Vec3{0, -1, 0}));
  EXPECT_EQ(scene.lights[0].side, (Vec3{1, 0, 0}));
  EXPECT_NEAR(dot(scene.lights[1].side, scene.lights[1].direction), 0, 1e-6f);
  EXPECT_NEAR(length(scene.lights[1].side), 1, 1e-6f);
  EXPECT_EQ(scene.lights[0].profile, 0u);
  EXPECT_EQ(scene.lights[1].profile, 1u);
  EXPECT_EQ(scene.lights[2].profile, kNone);
}

}  // namespace
}  // namespace luxel::scene
