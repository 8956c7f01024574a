// What only rays know that are followed on: places whose texel is wider than their light varies.
#include "solve/gather/near_paths.h"

#include <gtest/gtest.h>

#include "scene/shapes.h"
#include "solve/gather/gather.h"

namespace luxel::gather {
namespace {

struct Lit {
  atlas::TexelMap map;
  transport::Elements elements;
  Gather light;
};

Lit solve(const scene::Scene& scene, int resolution, int samples = 256) {
  Progress progress;
  atlas::AtlasParams params;
  params.resolution = resolution;
  params.uv = atlas::UvMode::unwrap;
  const auto atlas = atlas::make_atlas(scene, params, progress);
  EXPECT_TRUE(atlas);
  Lit out{atlas::rasterise(scene, *atlas), {}, {}};
  out.elements = transport::elements_from_texels(scene, *atlas, out.map);
  const auto tracer = trace::RayTracer::build(scene);
  auto light = gather(scene, *atlas, out.map, out.elements, transport::collect_lights(scene),
                      *tracer, {.samples = samples}, progress);
  EXPECT_TRUE(light);
  out.light = std::move(*light);
  return out;
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
    if (p.y != 0 || lit.elements.normal[i].y <= 0.5f) continue;
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
    if (lit.elements.position[i].y != 1) continue;
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

}  // namespace
}  // namespace luxel::gather
