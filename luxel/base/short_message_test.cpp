#include "luxel/base/short_message.h"

#include <gtest/gtest.h>

namespace luxel {
namespace {

TEST(ShortMessage, LeavesWhatIsShort) {
  for (const std::string& text : {std::string(), std::string("a: b  c\nd "), std::string(400, 'x')})
    EXPECT_EQ(short_message(text), text);
}

TEST(ShortMessage, CutsTheMiddleOfALongWord) {
  const std::string uri = "data:" + std::string(200000, 'A') + "end";
  EXPECT_EQ(short_message("the uri " + uri + " is wrong"),
            "the uri data:" + std::string(95, 'A') + "[199888 bytes]" + std::string(17, 'A') +
                "end is wrong");
}

TEST(ShortMessage, CutsAMessageOfManyWords) {
  std::string text;
  for (int i = 0; i < 10000; ++i) text += "word ";
  const std::string cut = short_message(text);
  EXPECT_LT(cut.size(), 4100u);
  EXPECT_TRUE(cut.ends_with("[50000 bytes in all]")) << cut.substr(3990);
  EXPECT_EQ(short_message(text, 12), "word word wo [50000 bytes in all]");
}

// A letter of two bytes starts at every odd place, where the cuts would fall at even ones.
TEST(ShortMessage, LettersOfSeveralBytesStayWhole) {
  std::string word = "x";
  for (int i = 0; i < 500; ++i) word += "\xc3\xa4";
  const std::string cut = short_message(word);
  EXPECT_LT(cut.size(), 200u);
  for (size_t i = 0; i < cut.size(); ++i) {
    if (cut[i] == '\xc3') {
      EXPECT_EQ(cut.substr(i, 2), "\xc3\xa4") << i;
    }
    if (cut[i] == '\xa4') {
      EXPECT_EQ(cut[i - 1], '\xc3') << i;
    }
  }
}

}  // namespace
}  // namespace luxel
