#include "luxel/display/contact_sheet.h"

#include <gtest/gtest.h>

#include "luxel/image/text.h"

namespace luxel::display {
namespace {

image::Image8 plain(int width, int height, uint8_t value, int channels = 3) {
  return {width, height, channels,
          std::vector<uint8_t>(size_t(width) * size_t(height) * size_t(channels), value)};
}

size_t count(const image::Image8& sheet, uint8_t value, int x0, int y0, int x1, int y1) {
  size_t n = 0;
  for (int y = y0; y < y1; ++y)
    for (int x = x0; x < x1; ++x)
      n += sheet.data[3 * (size_t(y) * size_t(sheet.width) + size_t(x))] == value ? 1 : 0;
  return n;
}

TEST(ContactSheet, HoldsEveryPictureWholeAndItsNameUnderIt) {
  std::vector<Tile> tiles;
  for (uint8_t i = 0; i < 5; ++i)
    tiles.push_back({"abc", plain(40, 30, uint8_t(100 + i), i % 2 ? 4 : 3)});
  const image::Image8 sheet = contact_sheet(tiles);
  ASSERT_EQ(sheet.channels, 3);
  for (uint8_t i = 0; i < 5; ++i)
    EXPECT_EQ(count(sheet, uint8_t(100 + i), 0, 0, sheet.width, sheet.height), 40u * 30) << int(i);
  // Each name has the ink of "abc".
  image::Image8 text = plain(40, 12, 0);
  image::draw_text(text, 0, 0, 1, {20, 20, 20}, "abc");
  const size_t ink = count(text, 20, 0, 0, 40, 12);
  EXPECT_EQ(count(sheet, 20, 0, 0, sheet.width, sheet.height), 5 * ink);
  // The first one stands below the first picture.
  EXPECT_EQ(count(sheet, 20, 8, 38, 48, 8 + 30 + 13), ink);
}

TEST(ContactSheet, LongNamesAreCutAtTheirTile) {
  const std::vector<Tile> tiles{{"a very long name indeed", plain(40, 30, 100)},
                                {"", plain(40, 30, 100)}};
  const image::Image8 sheet = contact_sheet(tiles);
  ASSERT_LT(sheet.height, 60);
  EXPECT_GT(count(sheet, 20, 8, 0, 48, sheet.height), 0u);
  EXPECT_EQ(count(sheet, 20, 48, 0, sheet.width, sheet.height), 0u);
}

TEST(ContactSheet, OfOnePixelAndOfOneTile) {
  const std::vector<Tile> one{{"abc", plain(1, 1, 7)}};
  EXPECT_EQ(contact_sheet(one).channels, 3);
}

TEST(ContactSheet, IsAboutAsWideAsAPage) {
  EXPECT_EQ(columns_for(1, 320, 240), 1);
  EXPECT_EQ(columns_for(9, 320, 240), 3);
  EXPECT_EQ(columns_for(12, 240, 240), 4);
  EXPECT_EQ(columns_for(4, 1000, 100), 1);
}

}  // namespace
}  // namespace luxel::display
