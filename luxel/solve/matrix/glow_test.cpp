#include "luxel/solve/matrix/glow.h"

#include <gtest/gtest.h>

#include "luxel/scene/shapes.h"
#include "luxel/solve/matrix/relighter_test_support.h"

namespace luxel::matrix {
namespace {

using testing::relighter_of;
using testing::relit;
using testing::small;
using testing::Stage;

constexpr float kLampHalf = 0.01f, kLampHeight = 1.5f;

/// A closed room of 2 m with a lamp of 2 cm under its ceiling.
scene::Scene room_with_small_lamp() {
  scene::Scene s;
  const uint32_t wall = scene::add_material(s, "wall", {0.6f, 0.5f, 0.4f});
  const uint32_t lamp = scene::add_material(s, "lamp", {}, {300, 200, 100});
  scene::Mesh mesh;
  mesh.name = "room";
  const auto add = [&](Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
    scene::add_quad(mesh, {a, b, c, d}, wall);
  };
  add({-1, 0, -1}, {-1, 0, 1}, {1, 0, 1}, {1, 0, -1});
  add({-1, 2, -1}, {1, 2, -1}, {1, 2, 1}, {-1, 2, 1});
  add({-1, 0, -1}, {1, 0, -1}, {1, 2, -1}, {-1, 2, -1});
  add({-1, 0, 1}, {-1, 0, -1}, {-1, 2, -1}, {-1, 2, 1});
  add({1, 0, -1}, {1, 0, 1}, {1, 2, 1}, {1, 2, -1});
  add({1, 0, 1}, {-1, 0, 1}, {-1, 2, 1}, {1, 2, 1});
  scene::place(s, std::move(mesh));
  scene::add_rectangle(s, {-kLampHalf, kLampHalf, -kLampHalf, kLampHalf}, kLampHeight, false, lamp);
  return s;
}

Rgb glow_of(const RelightData& d, size_t patch, uint32_t material) {
  for (uint32_t k = d.glow.first[patch]; k < d.glow.first[patch + 1]; ++k)
    if (d.glow.material[k] == material) return d.glow.irradiance[k];
  return {};
}

// E = A cos a cos b / (pi d^2) of a radiosity of 1, at the mean of the probes.
TEST(Glow, ASmallLampFallsOffAsTheSquareOfTheDistance) {
  const Stage stage(room_with_small_lamp(), small(CodecKind::dense32));
  const RelightData d = stage.data();
  constexpr uint32_t kLamp = 1;
  size_t lit = 0;
  for (size_t i = 0; i < d.size(); ++i) {
    if (d.material[i] == kLamp) continue;
    double want = 0;
    const uint32_t first = d.first_probe[i], end = d.first_probe[i + 1];
    for (uint32_t k = first; k < end; ++k) {
      const Vec3 to = Vec3{0, kLampHeight, 0} - d.probe[k].position;
      const double cosines = std::max(0.0, double(to.y)) * double(dot(d.probe[k].normal, to));
      const double d2 = double(dot(to, to));
      want += 4 * double(kLampHalf * kLampHalf) * std::max(0.0, cosines) /
              (double(kPi) * d2 * d2 * double(end - first));
    }
    // The lamp's size: (2 cm / 50 cm)^2.
    EXPECT_NEAR(double(glow_of(d, i, kLamp).y), want, 2e-3 * want + 1e-9) << i;
    lit += want > 0;
  }
  EXPECT_GT(lit, d.size() / 2);
}

// The light that comes first of a wall that did not glow is that of the factors: all of the
// hemisphere, in a closed room.
TEST(Glow, WhatCouldGlowIsSeenAsByTheFactors) {
  const Stage stage(room_with_small_lamp(), small(CodecKind::dense32));
  const RelightData d = stage.data();
  for (size_t i = 0; i < d.size(); ++i)
    if (d.material[i] == 0) {
      EXPECT_NEAR(double(glow_of(d, i, 0).x), 1, 5e-3) << i;
    }
}

// The light of a small lamp used to pass through the codec, which lost a tenth and more of it.
TEST(Glow, NoCodecLosesTheLightOfASmallLamp) {
  std::vector<Rgb> light[2];
  std::vector<float> area_m2;
  double stated = 0;
  for (const CodecKind codec : {CodecKind::hierarchical, CodecKind::dense32}) {
    const Stage stage(room_with_small_lamp(), small(codec));
    Relighter relighter = relighter_of(stage.data());
    light[codec == CodecKind::dense32] = relit(relighter, {}).indirect;
    area_m2 = relighter.data().area_m2;
    if (codec == CodecKind::hierarchical) stated = relighter.data().codec_error;
  }
  const double lost = testing::relative_error(light[0], light[1], area_m2);
  EXPECT_LE(lost, 0.01);  // RelightParams::max_error
  EXPECT_LE(lost, stated);
}

}  // namespace
}  // namespace luxel::matrix
