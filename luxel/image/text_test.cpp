#include "luxel/image/text.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace luxel::image {
namespace {

constexpr std::string_view kKnown =
    " abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-+.,:/()=%";

Image8 blank(int width, int height) {
  return {width, height, 3, std::vector<uint8_t>(size_t(width * height * 3))};
}

/// The picture as rows of '#' and '.'.
std::string drawn(const std::string& text, int scale = 1) {
  Image8 picture = blank(std::max(text_width(text, scale), 1), kGlyphHeight * scale);
  draw_text(picture, 0, 0, scale, {255, 255, 255}, text);
  std::string out;
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x)
      out += picture.data[size_t(3 * (y * picture.width + x))] ? '#' : '.';
    out += '\n';
  }
  return out;
}

TEST(Text, LettersLookLikeLetters) {
  EXPECT_EQ(drawn("l1"),
            ".##.....#..\n"
            "..#....##..\n"
            "..#.....#..\n"
            "..#.....#..\n"
            "..#.....#..\n"
            "..#.....#..\n"
            ".###...###.\n"
            "...........\n"
            "...........\n");
}

TEST(Text, EveryLetterDiffersFromEveryOther) {
  std::set<std::string> seen;
  for (const char c : kKnown) EXPECT_TRUE(seen.insert(drawn({c})).second) << c;
  EXPECT_TRUE(seen.insert(drawn("?")).second) << "an unknown sign is a box";
  EXPECT_EQ(drawn("?"), drawn("\x7f"));
}

TEST(Text, ScaleMakesSquares) {
  const std::string one = drawn("a"), three = drawn("a", 3);
  EXPECT_EQ(std::count(three.begin(), three.end(), '#'),
            9 * std::count(one.begin(), one.end(), '#'));
}

TEST(Text, IsCutOffAtTheEdges) {
  for (const int at : {-1000, -3, 0, 6, 1000}) {
    Image8 picture = blank(8, 8);
    draw_text(picture, at, at, 2, {1, 2, 3}, "mm");
    EXPECT_EQ(picture.data.size(), 8u * 8 * 3);
  }
}

TEST(Text, WidthHoldsTheText) {
  EXPECT_EQ(text_width("", 2), 0);
  EXPECT_EQ(text_width("ab", 1), 11);
  EXPECT_EQ(text_width("ab", 2), 22);
}

}  // namespace
}  // namespace luxel::image
