#include "luxel/base/shown_text.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace luxel {
namespace {

TEST(ShortMessage, LeavesWhatIsShort) {
  for (const std::string& text : {std::string(), std::string("a: b  c d "), std::string(400, 'x')})
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

// A terminal does nothing but show it, and it stays one line.
TEST(ShownText, ControlsMarksOfDirectionAndBadBytesAreEscapes) {
  const std::pair<const char*, const char*> cases[] = {
      {"x\nluxel: done\r\t", "x\\nluxel: done\\r\\t"},
      {"\x1b[31mred\x7f", "\\x1b[31mred\\x7f"},
      {"\xc2\x9b"
       "31m\xc2\x85",
       "\\u009b31m\\u0085"},
      {"a\xe2\x80\xae"
       "b\xe2\x81\xa6"
       "c\xe2\x80\xa8\xe2\x80\x8f\xd8\x9c",
       "a\\u202eb\\u2066c\\u2028\\u200f\\u061c"},
      {"W\xe4nde", "W\\xe4nde"},
      // Too long for what they say, a surrogate, beyond the last character, cut short.
      {"\xc0\x8a\xe0\x80\x8a\xed\xa0\x80\xf4\x90\x80\x80\xe2\x80",
       "\\xc0\\x8a\\xe0\\x80\\x8a\\xed\\xa0\\x80\\xf4\\x90\\x80\\x80\\xe2\\x80"},
      // Letters of every length, a joiner that they need, and backslashes.
      {"W\xc3\xa4nde \xe2\x82\xac \xf0\x9f\x92\xa1 a\xe2\x80\x8d"
       "b C:\\t",
       "W\xc3\xa4nde \xe2\x82\xac \xf0\x9f\x92\xa1 a\xe2\x80\x8d"
       "b C:\\t"},
  };
  for (const auto& [text, shown] : cases) {
    EXPECT_EQ(shown_text(text), shown);
    EXPECT_EQ(short_message(text), shown);
  }
  EXPECT_EQ(shown_text(std::string(1, '\0')), "\\x00");
}

TEST(ShownText, TwentyMegabytesAreCutWithoutBeingRead) {
  const std::string name(20'000'000, '\x1b');
  EXPECT_EQ(short_message(name).size(), 4 * 120 + std::string("[19999880 bytes]").size());
}

TEST(ShownText, WhatIsNoUtf8IsReplaced) {
  EXPECT_EQ(valid_utf8("T\xfcr\xc3\xbc\n\xe2\x80\xae"), "T\xef\xbf\xbdr\xc3\xbc\n\xe2\x80\xae");
}

// Another reader of JSON finds the value again, but for what is no UTF-8.
TEST(ShownText, JsonMeansWhatItMeant) {
  const std::string name =
      "a\xe2\x80\xae"
      "b\xc2\x9b\x7f\x1b\n\xc3\xa4";
  const nlohmann::json json{{"name", name}, {name, 1.5}};
  for (const int indent : {-1, 2}) {
    const std::string text = json_text(json, indent);
    EXPECT_EQ(nlohmann::json::parse(text), json);
    EXPECT_EQ(short_message(json_text(json)), json_text(json)) << "no character needs an escape";
    EXPECT_NE(text.find("a\\u202eb\\u009b\\u007f\\u001b\\n\xc3\xa4"), std::string::npos) << text;
  }
  EXPECT_EQ(json_text(nlohmann::json("T\xfcr")), "\"T\xef\xbf\xbdr\"");
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
