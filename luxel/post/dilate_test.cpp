#include "luxel/post/dilate.h"

#include <gtest/gtest.h>

#include <cstring>

#include "luxel/base/random.h"

namespace luxel::post {
namespace {

image::Image one_texel(int side, int x, int y, Rgb value) {
  image::Image image(side, side, 4);
  image.set_rgb(x, y, value);
  image.at(x, y)[3] = 1;
  return image;
}

TEST(LightmapFromTexels, PlacesValuesAndCoverage) {
  atlas::TexelMap map;
  map.resolution = 3;
  map.texels.resize(2);
  map.texels[0].x = 2, map.texels[0].centre_covered = true;
  map.texels[1].y = 1;
  const std::vector<Rgb> values{{1, 2, 3}, {4, 5, 6}};
  const image::Image lightmap = lightmap_from_texels(map, values);
  EXPECT_EQ(lightmap.rgb(2, 0), values[0]);
  EXPECT_EQ(lightmap.at(2, 0)[3], 1.0f);
  EXPECT_EQ(lightmap.rgb(0, 1), values[1]);
  EXPECT_EQ(lightmap.at(0, 1)[3], 0.5f);
  EXPECT_EQ(lightmap.at(1, 1)[3], 0.0f);
}

TEST(Dilate, GrowsByOneChessboardRingAtATime) {
  for (int rings = 0; rings < 5; ++rings) {
    image::Image image = one_texel(11, 4, 5, {1, 2, 3});
    dilate(image, rings);
    for (int y = 0; y < 11; ++y)
      for (int x = 0; x < 11; ++x) {
        const int distance = std::max(std::abs(x - 4), std::abs(y - 5));
        const float alpha = distance == 0 ? 1.0f : distance <= rings ? 0.5f : 0.0f;
        EXPECT_EQ(image.at(x, y)[3], alpha) << x << " " << y << " " << rings;
        EXPECT_FLOAT_EQ(image.rgb(x, y).y, distance <= rings ? 2.0f : 0.0f);
      }
  }
}

TEST(Dilate, TakesTheMeanOfCoveredNeighbours) {
  image::Image image = one_texel(3, 0, 0, {1, 1, 1});
  image.set_rgb(2, 0, {4, 4, 4});
  image.at(2, 0)[3] = 1;
  dilate(image, 1);
  EXPECT_EQ(image.rgb(1, 0).x, 2.5f);
  EXPECT_EQ(image.rgb(1, 1).x, 2.5f);
  EXPECT_EQ(image.rgb(0, 1).x, 1.0f);
  EXPECT_EQ(image.rgb(2, 1).x, 4.0f);
  EXPECT_EQ(image.at(0, 2)[3], 0.0f);
}

TEST(Dilate, NegativeRingsFillTheImageAndCoveredTexelsStay) {
  image::Image image(40, 40, 4);
  RandomStream random{5};
  for (int i = 0; i < 30; ++i) {
    const int x = int(random.next() * 40), y = int(random.next() * 40);
    image.set_rgb(x, y, {random.next(), random.next(), random.next()});
    image.at(x, y)[3] = i % 2 ? 1.0f : 0.5f;
  }
  const image::Image before = image;
  dilate(image, -1);
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 40; ++x) {
      EXPECT_GT(image.at(x, y)[3], 0);
      EXPECT_LE(max_component(image.rgb(x, y)), 1);
      if (before.at(x, y)[3] > 0) {
        EXPECT_EQ(std::memcmp(image.at(x, y), before.at(x, y), 4 * sizeof(float)), 0);
      }
    }
}

TEST(Dilate, AnEmptyImageStaysEmpty) {
  image::Image image(4, 4, 4);
  dilate(image, -1);
  for (const float v : image.data) EXPECT_EQ(v, 0);
}

}  // namespace
}  // namespace luxel::post
