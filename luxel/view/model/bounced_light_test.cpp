// Parts of light whose reflections are known.
#include "luxel/view/model/bounced_light.h"

#include <gmock/gmock.h>

namespace luxel::view {
namespace {

using ::testing::HasSubstr;

image::Image page_of(Rgb light) {
  image::Image out(3, 2, 4);
  for (int i = 0; i < 6; ++i)
    out.set_rgb(i % 3, i / 3, light * float(i)), out.at(i % 3, i / 3)[3] = 0.5f;
  return out;
}

/// After 0, 1 and 2 reflections 8, 12 and 14 of 16; numbers that halves hold.
struct Halving {
  BouncedLight bounced;
  std::vector<image::Image> all{page_of({16, 32, 64})};
  Halving() {
    for (const float part : {0.5f, 0.75f, 0.875f})
      bounced.after.push_back({image::to_half(page_of(Rgb{16, 32, 64} * part))});
  }
};

TEST(BouncedLight, IsToldApartByReflections) {
  const Halving h;
  const struct {
    LightShown light;
    float part;
  } cases[] = {
      {{}, 1},         {{0, 0}, 0.5f},   {{1, std::nullopt}, 0.5f}, {{0, 2}, 0.875f},
      {{1, 1}, 0.25f}, {{2, 2}, 0.125f}, {{1, 2}, 0.375f},          {{3, std::nullopt}, 0.125f}};
  for (const auto& c : cases) {
    const auto part = part_of(c.light, h.bounced, h.all);
    ASSERT_TRUE(part) << part.error().message;
    EXPECT_EQ(part->front().data, page_of(Rgb{16, 32, 64} * c.part).data) << words_of(c.light);
  }
}

TEST(BouncedLight, IsNoLessThanNothing) {
  Halving h;
  h.bounced.after[0] = {image::to_half(page_of({17, 33, 65}))};
  const auto part = part_of({1, std::nullopt}, h.bounced, h.all);
  ASSERT_TRUE(part);
  EXPECT_EQ(part->front().data, page_of({}).data);
}

TEST(BouncedLight, SaysWhatIsNotToldApart) {
  const Halving h;
  EXPECT_EQ(part_of({0, 3}, h.bounced, h.all).error().message,
            "light of 3 bounces is not known separately, only up to 2");
  EXPECT_FALSE(part_of({4, std::nullopt}, h.bounced, h.all));
  const auto none = read_bounced(::testing::TempDir() + "no_bounces", {});
  EXPECT_THAT(none.error().message, HasSubstr("no_bounces/bounces-0 --bounces 0`"));
}

TEST(BouncedLight, HasWordsForEachPart) {
  EXPECT_EQ(words_of({}), "all light");
  EXPECT_EQ(words_of({0, 0}), "direct");
  EXPECT_EQ(words_of({1, std::nullopt}), "indirect");
  EXPECT_EQ(words_of({0, 1}), "up to 1 bounce");
  EXPECT_EQ(words_of({0, 3}), "up to 3 bounces");
  EXPECT_EQ(words_of({2, 2}), "of bounce 2 only");
}

}  // namespace
}  // namespace luxel::view
