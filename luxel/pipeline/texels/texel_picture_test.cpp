#include "luxel/pipeline/texels/texel_picture.h"

#include <gtest/gtest.h>

#include "luxel/image/false_color.h"

namespace luxel::pipeline {
namespace {

using Color = std::array<int, 3>;

/// 24 x 24 texels: columns 0..11 are chart 0, columns 14..23 chart 1, with a gutter between.
struct Sheet {
  atlas::Atlas atlas;
  atlas::TexelMap map;

  Sheet() {
    constexpr uint32_t kSide = 24;
    atlas.resolution = map.resolution = kSide;
    atlas.chart = {0, 1}, atlas.chart_count = 2;
    map.texel_at.assign(kSide * kSide, atlas::kNone);
    for (uint32_t y = 0; y < kSide; ++y)
      for (uint32_t x = 0; x < kSide; ++x) {
        if (x >= 12 && x < 14) continue;
        map.texel_at[y * kSide + x] = uint32_t(map.texels.size());
        map.texels.push_back({uint16_t(x), uint16_t(y), {}, x < 12 ? 0u : 1u, true});
      }
  }
  uint32_t at(int x, int y) const { return map.texel_at[size_t(y * 24 + x)]; }
  Color color(const TexelFacts& facts, int x, int y) const {
    const std::vector<image::Image8> pages = draw_texels(atlas, map, facts);
    EXPECT_EQ(pages.size(), 1u);
    const uint8_t* p = &pages[0].data[size_t(3 * (y * 24 + x))];
    return {p[0], p[1], p[2]};
  }
};

/// The table of docs/method/leaks.md.
TEST(TexelPicture, ShowsWhatIsKnown) {
  const Sheet sheet;
  std::vector<uint8_t> hidden(sheet.map.texels.size());
  hidden[sheet.at(3, 3)] = hidden[sheet.at(4, 3)] = 1;
  const std::vector<uint32_t> moved{sheet.at(5, 3)}, refilled{sheet.at(4, 3)},
      overlapping{sheet.at(6, 3)};
  std::vector<float> seam(sheet.map.texels.size());
  seam[sheet.at(7, 3)] = 0.2f;
  const TexelFacts facts{hidden, overlapping, moved, refilled, seam};
  const Color light = sheet.color(facts, 2, 2), dark = sheet.color(facts, 9, 2);
  EXPECT_NE(light, dark);
  EXPECT_EQ(sheet.color(facts, 9, 10), light);  // squares of eight, like a chessboard
  EXPECT_EQ(sheet.color(facts, 2, 10), dark);
  EXPECT_EQ(sheet.color(facts, 12, 5), (Color{255, 255, 255}));
  EXPECT_EQ(sheet.color(facts, 3, 3), (Color{0, 0, 0}));
  EXPECT_EQ(sheet.color(facts, 11, 5), sheet.color(facts, 14, 9));  // borders
  EXPECT_NE(sheet.color(facts, 11, 5), sheet.color(facts, 10, 5));
  const Color yellow = sheet.color(facts, 4, 3), green = sheet.color(facts, 5, 3),
              magenta = sheet.color(facts, 6, 3), red = sheet.color(facts, 7, 3);
  EXPECT_TRUE(yellow[0] > 200 && yellow[1] > 150 && yellow[2] < 100);
  EXPECT_TRUE(green[1] > 2 * green[0] && green[1] > 2 * green[2]);
  EXPECT_TRUE(magenta[0] > 2 * magenta[1] && magenta[2] > 2 * magenta[1]);
  EXPECT_TRUE(red[0] > 4 * red[1] && red[0] > 4 * red[2]);
}

// Lightness grows with the logarithm of the error, and no more beyond the ends.
TEST(ErrorPicture, IsBrighterWhereLessIsKnown) {
  const Sheet sheet;
  std::vector<float> errors(sheet.map.texels.size(), 0.0f);
  errors[sheet.at(1, 1)] = 0.003f, errors[sheet.at(2, 1)] = 0.01f, errors[sheet.at(3, 1)] = 0.1f;
  errors[sheet.at(4, 1)] = 5;
  const std::vector<image::Image8> pages = draw_errors(sheet.atlas, sheet.map, errors);
  ASSERT_EQ(pages.size(), 1u);
  const auto color = [&](int x, int y) {
    const uint8_t* p = &pages[0].data[size_t(3 * (y * 24 + x))];
    return Color{p[0], p[1], p[2]};
  };
  const auto false_color = [](double t) {
    const image::Color8 c = image::false_color(t);
    return Color{c[0], c[1], c[2]};
  };
  EXPECT_EQ(color(0, 0), false_color(0));
  EXPECT_EQ(color(2, 1), false_color(0.5)) << "0.01 lies in the middle of 0.001 and 0.1";
  EXPECT_EQ(color(3, 1), false_color(1));
  EXPECT_EQ(color(4, 1), false_color(1));
  EXPECT_EQ(color(12, 5), (Color{255, 255, 255})) << "no texel";
}

}  // namespace
}  // namespace luxel::pipeline
