// Light beneath leaves: masks, two sides, light scattered through.
#include <gtest/gtest.h>

#include "base/random.h"
#include "bench/agreement.h"
#include "scene/procedural.h"
#include "scene/shapes.h"
#include "transport/direct_light.h"

namespace luxel::bench {
namespace {

/// What of a solution lies on the floor, instance 0.
struct Floor {
  std::vector<size_t> texels;
  transport::Elements elements;
};
Floor floor_of(const Prepared& p) {
  Floor out;
  for (size_t i = 0; i < p.map.texels.size(); ++i) {
    if (p.map.texels[i].sample.instance != 0) continue;
    out.texels.push_back(i);
    out.elements.position.push_back(p.elements.position[i]);
    out.elements.normal.push_back(p.elements.normal[i]);
    out.elements.geometric_normal.push_back(p.elements.geometric_normal[i]);
    out.elements.reflectance.push_back(p.elements.reflectance[i]);
  }
  return out;
}

struct Mean {
  double solved = 0, judged = 0;
};

// The floor under twigs, texel by texel and in the mean, also of the texels in shadow alone. The
// judge follows every path by itself; gather reads the leaves' light from their texels, some four
// across a leaf.
TEST(SlowFoliage, LightBeneathLeavesIsThatOfThePathTracer) {
  constexpr int kPaths = 1024;
  scene::Scene scene = scene::foliage();
  scene.lights[0].angular_radius_rad = 0.02f;  // shadows with soft rims
  Progress progress;
  const auto prepared = prepare(std::move(scene), 160, progress);
  ASSERT_TRUE(prepared) << prepared.error().message;
  const Prepared& p = **prepared;
  for (const scene::Mesh& mesh : p.scene.meshes)
    EXPECT_EQ(mesh.other_side.empty(), mesh.name != "twig") << mesh.name;
  const Floor floor = floor_of(p);
  const auto judged =
      judge(p.scene, *p.tracer, reference::receivers(floor.elements), kPaths, 1, progress);
  ASSERT_TRUE(judged);
  pipeline::BakeSettings settings;
  settings.samples = 1024, settings.direct_samples = 256, settings.seed = 7;
  const auto solved = solve(p, "gather", settings, progress);
  ASSERT_TRUE(solved) << solved.error().message;
  std::vector<Rgb> light;
  for (const size_t i : floor.texels) light.push_back(solved->light.irradiance[i]);
  const Agreement a = agreement(light, {}, *judged);
  double brightest = 0;
  for (const Rgb& e : light) brightest = std::max(brightest, double(luminance(e)));
  Mean all, shadow;
  size_t in_shadow = 0;
  for (size_t k = 0; k < light.size(); ++k) {
    const double s = double(luminance(light[k])), j = double(luminance(judged->mean(k)));
    all.solved += s, all.judged += j;
    if (s > 0.4 * brightest) continue;
    shadow.solved += s, shadow.judged += j, ++in_shadow;
  }
  std::printf("floor: %zu texels, %zu in shadow; relative RMSE %.4f, mean %+.4f, shadow %+.4f\n",
              light.size(), in_shadow, a.relative_rmse, all.solved / all.judged - 1,
              shadow.solved / shadow.judged - 1);
  EXPECT_GT(light.size(), 2000u);
  EXPECT_GT(in_shadow, 300u);
  EXPECT_LE(a.relative_rmse, 0.02);
  EXPECT_NEAR(all.solved / all.judged, 1, 0.01);
  EXPECT_NEAR(shadow.solved / shadow.judged, 1, 0.02);
}

// A sun straight above a mask of random holes: the mean light below is what the holes let through.
TEST(Foliage, AMaskLetsThroughTheShareOfItsHoles) {
  constexpr int kCells = 32;
  scene::Scene s;
  scene::add_material(s, "floor", {});
  const uint32_t leaves = scene::add_material(s, "leaves", {});
  scene::Texture holes;
  holes.width = holes.height = kCells;
  RandomStream random{5};
  for (int k = 0; k < kCells * kCells; ++k)
    holes.rgba.insert(holes.rgba.end(), {0, 0, 0, uint8_t(random.next() < 0.6f ? 255 : 0)});
  // The floor lies under the middle 16 x 16 cells.
  double open = 0;
  for (int j = kCells / 4; j < 3 * kCells / 4; ++j)
    for (int i = kCells / 4; i < 3 * kCells / 4; ++i)
      open += holes.rgba[size_t(4 * (j * kCells + i) + 3)] == 0;
  open /= 0.25 * kCells * kCells;
  s.textures.push_back(std::move(holes));
  s.materials[leaves].base_color_texture = {.texture = 0, .filter = scene::Filter::nearest};
  s.materials[leaves].alpha_mode = scene::AlphaMode::mask;
  scene::add_rectangle(s, {-0.5f, 0.5f, -0.5f, 0.5f}, 0, true, 0);
  scene::add_rectangle(s, {-1, 1, -1, 1}, 1, false, leaves);
  for (const Vec3& p : s.meshes[1].positions)
    s.meshes[1].uv0.push_back({0.5f * p.x + 0.5f, 0.5f * p.z + 0.5f});
  scene::PunctualLight sun;
  sun.kind = scene::PunctualLight::Kind::directional;
  sun.intensity = {4, 4, 4};
  s.lights.push_back(sun);
  Progress progress;
  const auto prepared = prepare(std::move(s), 256, progress);
  ASSERT_TRUE(prepared) << prepared.error().message;
  const Floor floor = floor_of(**prepared);
  const auto light = transport::direct_light(
      (*prepared)->scene, floor.elements, (*prepared)->lights, *(*prepared)->tracer, {}, progress);
  ASSERT_TRUE(light);
  double mean = 0;
  for (const Rgb& e : light->irradiance) mean += double(e.x) / double(floor.texels.size());
  ASSERT_GT(floor.texels.size(), 5000u);
  // Cells are 5 texels wide or more; texels on their rims fall to either side at random.
  EXPECT_NEAR(mean, 4 * open, 0.01 * 4);
  EXPECT_GT(open, 0.3);
  EXPECT_LT(open, 0.5);
}

}  // namespace
}  // namespace luxel::bench
