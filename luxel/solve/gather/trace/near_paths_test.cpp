// Light that varies within a texel: only rays that are followed on know it.
#include "luxel/solve/gather/trace/near_paths.h"

#include <gtest/gtest.h>

#include "luxel/scene/shapes.h"
#include "luxel/solve/gather/gather_test_support.h"

namespace luxel::gather {
namespace {

struct Lit {
  transport::Elements elements;
  Gather light;
};

Lit solve(scene::Scene scene, int resolution, int samples = 256) {
  const auto room = lay_out(std::move(scene), resolution);
  return {room->elements, gather::solve(*room, with_samples(samples))};
}

// A wide plate 1 mm above a small one, under an even sky of radiance 1. Of the wide plate's lower
// side the map knows nothing but its light beside the small plate; between the two it is dark. A
// point at a distance d from the slit's edges sees the sky through a slit as high as 0.001 / d.
TEST(NearPaths, ASlitIsDark) {
  scene::Scene scene;
  scene.background = {1, 1, 1};
  const uint32_t white = scene::add_material(scene, "white", {0.5f, 0.5f, 0.5f}, {});
  scene::add_rectangle(scene, {-0.2f, 0.2f, -0.2f, 0.2f}, 0, true, white);
  scene::add_rectangle(scene, {-2, 2, -2, 2}, 0.001f, false, white);
  const Lit lit = solve(scene, 16);
  size_t inside = 0, wide_lit = 0;
  for (size_t i = 0; i < lit.elements.size(); ++i) {
    const Vec3 p = lit.elements.position[i];
    const float e = lit.light.irradiance[i].x;
    if (lit.elements.normal[i].y > 0 && std::max(std::abs(p.x), std::abs(p.z)) < 0.15f) {
      // 50 mm from the edge the sky is 0.02 radians high and low over the horizon, and the plates
      // hand on half of it each time.
      EXPECT_LT(e, 0.02f * kPi);
      ++inside;
    }
    if (lit.elements.normal[i].y < 0 && length(p) > 0.5f) wide_lit += e > 0.5f * kPi;
  }
  EXPECT_GT(inside, 0u);
  EXPECT_GT(wide_lit, 20u);  // what must not leak in
}

// A floor that passes through a closed box of double-sided walls, under an even sky: inside it is
// dark, though every ray there meets a wall whose front lies in the light.
TEST(NearPaths, AClosedDoubleSidedBoxIsDarkInside) {
  scene::Scene scene;
  scene.background = {1, 1, 1};
  const uint32_t gray = scene::add_material(scene, "gray", {0.5f, 0.5f, 0.5f}, {});
  const uint32_t wall = scene::add_material(scene, "wall", {0.8f, 0.8f, 0.8f}, {});
  scene.materials[wall].double_sided = true;
  scene::add_rectangle(scene, {-3, 3, -3, 3}, 0, true, gray);
  scene::Mesh box;
  scene::add_box(box, {-0.5f, -0.2f, -0.5f}, {0.5f, 1, 0.5f}, wall);
  scene::place(scene, std::move(box));
  const Lit lit = solve(scene, 64);
  size_t inside = 0, outside = 0;
  for (size_t i = 0; i < lit.elements.size(); ++i) {
    const Vec3 p = lit.elements.position[i];
    if (std::abs(p.y) > 1e-4f || lit.elements.normal[i].y <= 0.5f) continue;
    const float side = std::max(std::abs(p.x), std::abs(p.z)), e = lit.light.irradiance[i].x;
    if (side < 0.45f) {
      // Paths end on the floor again, farther away, where the map between texels mixes a little of
      // what lies outside; the walls' fronts would bring 2 and more.
      EXPECT_LT(e, 0.01f * kPi);
      ++inside;
    }
    if (side > 1) {
      EXPECT_GT(e, 0.5f * kPi);
      ++outside;
    }
  }
  EXPECT_GT(inside, 10u);
  EXPECT_GT(outside, 100u);
}

// A wide leaf, double-sided, its front close over black ground, under an even sky of radiance 1:
// E = pi on its back, about nothing on its front. A small plate 1 m above it sees the back,
// B = rho pi, with the factor F of a point to a rectangle, and past it the sky.
TEST(NearPaths, ALeafSendsTheLightOfTheSideThatIsSeen) {
  scene::Scene scene;
  scene.background = {1, 1, 1};
  const uint32_t leaf = scene::add_material(scene, "leaf", {0.5f, 0.5f, 0.5f}, {});
  scene.materials[leaf].double_sided = true;
  const uint32_t black = scene::add_material(scene, "black", {}, {});
  // The leaf lies on black ground, front down: its front is dark.
  scene::add_rectangle(scene, {-5, 5, -5, 5}, 0.0f, false, leaf);
  scene::add_rectangle(scene, {-5, 5, -5, 5}, -0.01f, true, black);
  scene::add_rectangle(scene, {-0.05f, 0.05f, -0.05f, 0.05f}, 1, false, black);
  const Lit lit = solve(scene, 64, 4096);
  size_t seen = 0;
  for (size_t i = 0; i < lit.elements.size(); ++i) {
    if (std::abs(lit.elements.position[i].y - 1) > 1e-4f) continue;
    // F to the leaf, x = y = 5 and h = 1 for each quarter: 4 * 0.2405 = 0.9623. E = F rho pi + (1 -
    // F) pi, but for what the small plate shades: its own solid angle over pi, 0.01 / pi.
    const double f =
        4 * 2 * (5 / std::sqrt(26.0) * std::atan(5 / std::sqrt(26.0))) / (2 * double(kPi));
    const double exact = double(kPi) * (0.5 * f + 1 - f);
    EXPECT_NEAR(double(lit.light.irradiance[i].x), exact, 0.02 * exact);
    ++seen;
  }
  EXPECT_GT(seen, 0u);
}

// A black floor before a wall, x = 0, both large, with texels of about a metre: half of what floor
// texels beside the wall see of it is nearer than that, and followed on.
constexpr float kSize = 20;

struct WallCase {
  Rgb wall;         ///< its reflectance
  float sky = 0;    ///< radiance
  float sun = 0;    ///< irradiance of the wall, without glass
  float glass = 1;  ///< tint of a pane 5 cm in front of the wall; 1: none
};

Lit wall_and_floor(const WallCase& c) {
  scene::Scene scene;
  scene.background = Rgb{1, 1, 1} * c.sky;
  const uint32_t black = scene::add_material(scene, "floor", {}, {});
  const uint32_t gray = scene::add_material(scene, "wall", c.wall, {});
  const auto add_wall = [&](float x, uint32_t material) {
    scene::Mesh mesh;
    scene::add_quad(
        mesh, {Vec3{x, 0, kSize}, {x, 0, -kSize}, {x, kSize, -kSize}, {x, kSize, kSize}}, material);
    scene::place(scene, std::move(mesh));
  };
  scene::add_rectangle(scene, {0, kSize, -kSize, kSize}, 0, true, black);
  add_wall(0, gray);
  if (c.glass < 1) {
    const uint32_t pane = scene::add_material(scene, "pane", Rgb{1, 1, 1} * c.glass, {});
    scene.materials[pane].transmission = 1, scene.materials[pane].double_sided = true;
    add_wall(0.05f, pane);
  }
  if (c.sun > 0) {
    scene::PunctualLight sun;
    sun.kind = scene::PunctualLight::Kind::directional;
    sun.direction = normalize(Vec3{-1, -1, 0}),
    sun.intensity = Rgb{1, 1, 1} * (c.sun * std::sqrt(2.0f));
    scene.lights.push_back(sun);
  }
  return solve(scene, 64, 1024);
}

/// Share of what a floor point sees, at a distance x from the wall, that is the wall between two
/// heights: half the difference of the sines of the angles from up.
double wall_factor(double x, double low, double high) {
  return 0.5 * (x / std::hypot(x, low) - x / std::hypot(x, high));
}

/// E at a floor point from the wall, strip by strip. A wall point at a height y sees the floor with
/// (1 - y / |(y, size)|) / 2 and the sky with the rest.
double light_from_wall(const WallCase& c, double x) {
  double sum = 0;
  const int strips = 1000;
  for (int k = 0; k < strips; ++k) {
    const double low = double(kSize) * k / strips, high = double(kSize) * (k + 1) / strips;
    const double y = 0.5 * (low + high);
    const double sees_sky = 0.5 * (1 + y / std::hypot(y, double(kSize)));
    const double e = double(c.sun) + double(kPi) * double(c.sky) * sees_sky;
    // Light passes the pane on its way there and on its way back.
    sum += wall_factor(x, low, high) * double(c.wall.x * c.glass * c.glass) * e;
  }
  return sum;
}

// A scene with a black wall has the same rays, and what the floor sees beside the wall with it:
// the difference is the wall's light.
TEST(NearPaths, BringTheLightOfWhereTheyEnd) {
  const Rgb half{0.5f, 0.5f, 0.5f}, dark{0.05f, 0.05f, 0.05f};
  for (WallCase c :
       {WallCase{half, 0, 3}, {half, 1, 0}, {dark, 1, 0}, {half, 0, 3, 0.6f}, {half, 1, 0, 0.6f}}) {
    const Lit lit = wall_and_floor(c);
    const WallCase with_wall = c;
    c.wall = {};
    const Lit unlit = wall_and_floor(c);
    ASSERT_EQ(unlit.elements.size(), lit.elements.size());
    double sum = 0, exact = 0;
    for (size_t i = 0; i < lit.elements.size(); ++i) {
      const Vec3 p = lit.elements.position[i];
      if (lit.elements.normal[i].y < 0.5f || p.x > 1 || p.x < 0.1f || std::abs(p.z) > 10) continue;
      sum += double(lit.light.irradiance[i].x - unlit.light.irradiance[i].x);
      exact += light_from_wall(with_wall, double(p.x));
    }
    ASSERT_GT(exact, 0);
    // The wall ends after 20 m, where it should go on for ever (1 %), and dark paths that go on by
    // chance are noise: 20 texels with 1024 rays, a fifth of them near (1 %).
    EXPECT_NEAR(sum / exact, 1, 0.04)
        << c.sky << " " << c.sun << " " << c.glass << " " << with_wall.wall.x;
  }
}

// A small floor under a wide double-sided plate, whose back sends it the light of the sky below. A
// small square between them shows its back, which is dark: it takes its own part of that light, and
// no more.
TEST(NearPaths, ADarkBackTakesOnlyItsOwnPartOfTheLightOfALitOne) {
  const auto mean_of_floor = [](bool with_square) {
    scene::Scene scene;
    scene.background = {1, 1, 1};
    const uint32_t gray = scene::add_material(scene, "gray", {0.8f, 0.8f, 0.8f}, {});
    const uint32_t leaf = scene::add_material(scene, "leaf", {0.8f, 0.8f, 0.8f}, {});
    scene.materials[leaf].double_sided = true;
    scene::add_rectangle(scene, {-0.2f, 0.2f, -0.2f, 0.2f}, 0, true, gray);
    scene::add_rectangle(scene, {-2, 2, -2, 2}, 1, true, leaf);
    if (with_square) scene::add_rectangle(scene, {-0.1f, 0.1f, -0.1f, 0.1f}, 0.5f, true, gray);
    const Lit lit = solve(std::move(scene), 32, 64);
    double sum = 0;
    int count = 0;
    for (size_t i = 0; i < lit.elements.size(); ++i) {
      if (lit.elements.position[i].y > 0.1f) continue;
      sum += double(lit.light.irradiance[i].x), ++count;
    }
    EXPECT_GT(count, 5);
    return sum / count;
  };
  // The square's form factor is 0.04 / (0.25 pi) = 0.05. Noise: 0.02.
  EXPECT_NEAR(mean_of_floor(true) / mean_of_floor(false), 0.95, 0.04);
}

}  // namespace
}  // namespace luxel::gather
