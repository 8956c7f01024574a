#include "luxel/atlas/footprint.h"

#include <gtest/gtest.h>

#include "luxel/atlas/atlas_test_support.h"

namespace luxel::atlas {
namespace {

Vec2 place_in_atlas(const Atlas& atlas, const scene::SurfacePoint& p) {
  const auto& c = atlas.corners[atlas.triangle_number(p.instance, p.triangle)];
  return interpolate(c[0], c[1], c[2], p.at);
}

// Bent, folded and thin charts: every point lies in its texel, on a triangle of its chart.
TEST(Footprint, PointsLieInTheirTexelAndChart) {
  const scene::Scene scene = testing::mixed_scene();
  Progress progress;
  AtlasParams params;
  params.resolution = 256;
  params.uv = UvMode::unwrap;
  const auto atlas = make_atlas(scene, params, progress);
  ASSERT_TRUE(atlas) << atlas.error().message;
  const TexelMap map = rasterise(scene, *atlas);
  std::vector<uint32_t> asked;
  for (uint32_t i = 0; i < map.texels.size(); i += 3) asked.push_back(i);
  const Cover cover = cover_of(*atlas, map, asked);
  std::vector<scene::SurfacePoint> points;
  size_t full = 0;
  for (size_t k = 0; k < asked.size(); ++k) {
    const Texel& texel = map.texels[asked[k]];
    spread_points(*atlas, texel, cover.of(k), 16, 1, points);
    full += points.size() == 16;
    for (const scene::SurfacePoint& p : points) {
      const Vec2 at = place_in_atlas(*atlas, p);
      // Floats of the atlas hold about 1e-5 texels.
      EXPECT_NEAR(at.x, float(texel.x) + 0.5f, 0.5f + 1e-4f);
      EXPECT_NEAR(at.y, float(texel.y) + 0.5f, 0.5f + 1e-4f);
      EXPECT_EQ(atlas->chart[atlas->triangle_number(p.instance, p.triangle)],
                atlas->chart[texel.triangle_number]);
    }
  }
  // Sixteen tries per point fill whatever covers more than a tenth or so of its texel.
  EXPECT_GT(full, asked.size() / 2);
}

}  // namespace
}  // namespace luxel::atlas
