#include "luxel/post/texel_tile.h"

#include <gtest/gtest.h>

#include "luxel/base/random.h"

namespace luxel::post {
namespace {

/// A rough sheet of 90 x 90 texels in two regions, with holes: more than a tile.
struct RoughSheet {
  atlas::TexelMap map;
  Neighbourhood n;

  RoughSheet() {
    map.resolution = 90, map.texel_at.assign(90 * 90, atlas::kNone);
    RandomStream random{1};
    for (uint16_t y = 0; y < 90; ++y)
      for (uint16_t x = 0; x < 90; ++x) {
        if (random.next() < 0.1f) continue;
        map.texel_at[size_t(y) * 90 + x] = uint32_t(map.texels.size());
        atlas::Texel texel;
        texel.x = x, texel.y = y;
        map.texels.push_back(texel);
        const Vec3 normal{random.next() - 0.5f, random.next() - 0.5f, 2};
        n.place.push_back({{float(x), float(y), 0.4f * random.next()},
                           random.next() < 0.05f ? 0.0f : 1.0f,
                           normalize(normal),
                           x < 40 ? 0u : 7u});
      }
    n.map = &map, n.radius = 3, n.min_cosine = 0.9f;
  }
};

/// Eight neighbours at once are those that neighbour() finds one by one, to a few roundings, and
/// all texels are in just one tile.
TEST(TexelTile, EightNeighboursAreWhatEachIsAlone) {
  const RoughSheet sheet;
  const Neighbourhood& n = sheet.n;
  std::vector<int> seen(n.place.size());
  size_t counted = 0;
  TexelTile tile;
  for (size_t number = 0; number < tile_count(n); ++number) {
    fill_tile(
        n, number, n.radius, [](size_t) {}, [](size_t, uint32_t) {}, tile);
    for_texels_of(n, tile, n.radius, [&](uint32_t i, size_t cell) {
      ++seen[i];
      const Around self = around(n.place[i], 4, n.min_cosine);
      NeighbourLanes lanes;
      neighbours_in(tile, self, cell - 3 * tile.stride - 3, lanes);
      for (int k = 0; k < 7; ++k) {
        const int x = int(sheet.map.texels[i].x) + k - 3, y = int(sheet.map.texels[i].y) - 3;
        const uint32_t j = texel_at(sheet.map, x, y);
        const Neighbour alone = j == atlas::kNone ? Neighbour{} : neighbour(self, n.place[j]);
        ASSERT_NEAR(lanes.weight[k], alone.weight, 1e-6f);
        if (alone.weight <= 0) continue;
        ASSERT_NEAR(lanes.u[k], alone.u, 1e-5f);
        ASSERT_NEAR(lanes.v[k], alone.v, 1e-5f);
        ++counted;
      }
    });
  }
  EXPECT_GT(counted, 500u);
  for (const int times : seen) EXPECT_EQ(times, 1);
}

}  // namespace
}  // namespace luxel::post
