#include "luxel/display/smooth_lookup.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "luxel/display/lightmap_lookup.h"

namespace luxel::display {
namespace {

using Flags = std::array<bool, 16>;

Flags all_inside() {
  Flags out;
  out.fill(true);
  return out;
}

/// Two triangles whose lightmap coordinates are their places: a unit square.
scene::Scene square() {
  scene::Scene scene;
  scene::Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  mesh.uv1 = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.triangle_material = {0, 0};
  scene.materials.emplace_back();
  scene.meshes.push_back(mesh);
  scene.instances.push_back({"square", 0, {}});
  return scene;
}

/// The place (x, y) of square().
scene::SurfacePoint place(float x, float y) {
  return y <= x ? scene::SurfacePoint{0, 0, {x - y, y}} : scene::SurfacePoint{0, 1, {x, y - x}};
}

// The quadratic B-spline is 3/4 at its middle, 1/8 a texel away and 1/2 half a texel away, and its
// sums are exact for linear functions. It ends a texel and a half away.
TEST(SmoothWeights, AreThoseOfTheQuadraticSpline) {
  const SmoothWeights middle = smooth_weights({0, 0}, all_inside());
  EXPECT_EQ(middle.share, 1);
  EXPECT_FLOAT_EQ(middle.weight[5], 0.75f * 0.75f);
  EXPECT_FLOAT_EQ(middle.weight[4], 0.125f * 0.75f);
  EXPECT_FLOAT_EQ(middle.weight[10], 0.125f * 0.125f);
  EXPECT_FLOAT_EQ(smooth_weights({0.5f, 0}, all_inside()).weight[6], 0.5f * 0.75f);
  std::mt19937 random(3);
  std::uniform_real_distribution<float> number(0, 1);
  for (int i = 0; i < 1000; ++i) {
    const Vec2 to{number(random), number(random)};
    const SmoothWeights w = smooth_weights(to, all_inside());
    float sum = 0, x = 0, y = 0;
    for (size_t k = 0; k < 16; ++k) {
      sum += w.weight[k];
      x += w.weight[k] * (float(k % 4) - 1), y += w.weight[k] * (float(k / 4) - 1);
      const bool is_beyond = k % 4 == (to.x < 0.5f ? 3 : 0);
      EXPECT_TRUE(!is_beyond || w.weight[k] == 0);
    }
    EXPECT_NEAR(w.share, 1, 1e-6);
    EXPECT_NEAR(sum, 1, 1e-6);
    EXPECT_NEAR(x, to.x, 1e-6);
    EXPECT_NEAR(y, to.y, 1e-6);
  }
}

/// The look-up in a strip of texels, five wide and four high, at x = 1 .. 3 and between the two
/// middle rows: the spline and the bilinear part.
float look_up(const std::array<float, 20>& light, const std::array<bool, 20>& inside, Vec2 at,
              size_t first) {
  Flags flags;
  for (size_t k = 0; k < 16; ++k) flags[k] = inside[5 * (k / 4) + first + k % 4];
  const SmoothWeights w = smooth_weights(at, flags);
  const auto value = [&](size_t k) { return light[5 * (k / 4) + first + k % 4]; };
  float spline = 0;
  for (size_t k = 0; k < 16; ++k) spline += w.weight[k] * value(k);
  const float bilinear = (value(5) * (1 - at.x) + value(6) * at.x) * (1 - at.y) +
                         (value(9) * (1 - at.x) + value(10) * at.x) * at.y;
  return w.share * spline + (1 - w.share) * bilinear;
}

// Texels outside of the chart are not read by the spline, whatever they hold; it has no share where
// none of the four is surrounded; and light does not jump where one place's 4 x 4 texels end and
// the next one's begin.
TEST(SmoothWeights, FadeOutTowardsTheRimOfAChart) {
  std::mt19937 random(4);
  std::uniform_real_distribution<float> number(0, 1);
  for (int trial = 0; trial < 5000; ++trial) {
    std::array<float, 20> light;
    std::array<bool, 20> inside;
    for (size_t k = 0; k < 20; ++k) light[k] = number(random), inside[k] = number(random) < 0.93f;
    const float y = number(random);
    const float left = look_up(light, inside, {1, y}, 0);
    const float right = look_up(light, inside, {0, y}, 1);
    EXPECT_NEAR(left, right, 2e-6);
    Flags flags;
    std::copy_n(inside.begin(), 16, flags.begin());
    const SmoothWeights w = smooth_weights({number(random), y}, flags);
    for (size_t k = 0; k < 16; ++k) EXPECT_TRUE(flags[k] || w.weight[k] == 0);
  }
  for (size_t k : {5, 6, 9, 10}) {
    Flags flags = all_inside();
    flags[k] = false;  // it lies in the 3 x 3 texels of all four
    EXPECT_EQ(smooth_weights({0.3f, 0.6f}, flags).share, 0);
  }
}

/// Sunlight below a line of slope 0.4, as texels hold it: each the lit part of its area.
image::Image sun_edge(int side) {
  constexpr int kAcross = 16;
  image::Image map(side, side, 4);
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      int lit = 0;
      for (int k = 0; k < kAcross * kAcross; ++k)
        lit += float(y) + (float(k / kAcross) + 0.5f) / kAcross <
               0.4f * (float(x) + (float(k % kAcross) + 0.5f) / kAcross) + 10.3f;
      const float e = float(lit) / (kAcross * kAcross);
      map.set_rgb(x, y, {e, e, e}), map.at(x, y)[3] = 1;
    }
  return map;
}

/// The distance by which the line at which `at(x, y)` falls below a tenth is off the straight one,
/// in texels.
template <class At>
float teeth(const At& at, int side) {
  float least = INFINITY, most = -INFINITY;
  for (int k = 0; k <= 80; ++k) {
    const float x = 8 + 0.2f * float(k), line = 0.4f * x + 10.3f;
    float low = line - 3, high = line + 3;
    for (int i = 0; i < 20; ++i) {
      const float middle = (low + high) / 2;
      (at(x / float(side), middle / float(side)) < 0.1f ? high : low) = middle;
    }
    least = std::min(least, low - line), most = std::max(most, low - line);
  }
  return most - least;
}

// A separate computation has 0.425 texels for the bilinear look-up and 0.196 for the spline.
TEST(SmoothLightmapAt, SunEdgesHaveHalfTheTeeth) {
  const scene::Scene scene = square();
  const image::Image map = sun_edge(32);
  const float bilinear =
      teeth([&](float x, float y) { return lightmap_at(scene, map, place(x, y)).y; }, map.width);
  const float smooth = teeth(
      [&](float x, float y) { return smooth_lightmap_at(scene, map, place(x, y)).y; }, map.width);
  EXPECT_NEAR(bilinear, 0.425f, 0.02f);
  EXPECT_NEAR(smooth, 0.196f, 0.02f);
}

// At the rim and beside texels of another alpha nothing changes.
TEST(SmoothLightmapAt, IsBilinearAtTheRim) {
  const scene::Scene scene = square();
  image::Image map = sun_edge(32);
  for (int y = 0; y < 32; ++y) map.at(16, y)[3] = 0.5f;
  for (const float v : {0.1f, 0.45f, 0.83f})
    for (const float x : {0.3f, 15.6f, 16.2f, 17.4f, 31.8f}) {
      const scene::SurfacePoint p = place(x / 32, v);
      EXPECT_EQ(smooth_lightmap_at(scene, map, p), lightmap_at(scene, map, p)) << x;
    }
  const scene::SurfacePoint inner = place(0.26f, 0.44f);
  EXPECT_NE(smooth_lightmap_at(scene, map, inner), lightmap_at(scene, map, inner));
}

/// Two squares side by side in the atlas without a gutter, the left one dark, the right one bright.
struct TwoCharts {
  scene::Scene scene = square();
  atlas::Atlas atlas;
  atlas::TexelMap map;
  std::vector<Rgb> light;

  TwoCharts() {
    constexpr int kSide = 16;
    scene.instances.push_back(scene.instances[0]);
    atlas.resolution = map.resolution = kSide;
    atlas.first_triangle = {0, 2, 4};
    atlas.chart = {0, 0, 1, 1}, atlas.chart_count = 2;
    for (const float x : {0.0f, 8.0f})
      for (const auto& t : scene.meshes[0].triangles) {
        auto& corners = atlas.corners.emplace_back();
        for (size_t k = 0; k < 3; ++k) {
          const Vec2 uv = scene.meshes[0].uv1[t[k]];
          corners[k] = {x + 8 * uv.x, 16 * uv.y};
        }
      }
    map = atlas::rasterise(scene, atlas);
    for (const atlas::Texel& texel : map.texels) {
      const float e = texel.x < 8 ? 0.0f : 1e6f + float(texel.y % 2);
      light.push_back({e, e, e});
    }
  }
};

// No light comes over from the other chart but what a bilinear look-up brings.
TEST(SmoothIrradianceAt, ReadsItsOwnChart) {
  const TwoCharts two;
  const transport::TexelField field{&two.atlas, &two.map, two.light};
  int smooth = 0;
  for (int k = 0; k < 400; ++k) {
    scene::SurfacePoint p = place((float(k % 20) + 0.4f) / 20, (float(k / 20) + 0.3f) / 20);
    EXPECT_EQ(smooth_irradiance_at(field, p), transport::irradiance_at(field, p));
    p.instance = 1;
    smooth += smooth_irradiance_at(field, p) != transport::irradiance_at(field, p);
  }
  EXPECT_GT(smooth, 100);
}

}  // namespace
}  // namespace luxel::display
