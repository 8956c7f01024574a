#include "luxel/base/base64.h"

#include <gtest/gtest.h>

#include <map>
#include <string_view>

namespace luxel {
namespace {

std::string encoded(std::string_view text) {
  return base64(std::as_bytes(std::span(text.data(), text.size())));
}

std::string decoded(std::string_view text) {
  const auto bytes = from_base64(text);
  return bytes ? std::string(reinterpret_cast<const char*>(bytes->data()), bytes->size()) : "none";
}

// [RFC 4648, section 10]
TEST(Base64, TestVectors) {
  const std::map<std::string, std::string> vectors = {{"", ""},
                                                      {"f", "Zg=="},
                                                      {"fo", "Zm8="},
                                                      {"foo", "Zm9v"},
                                                      {"foob", "Zm9vYg=="},
                                                      {"fooba", "Zm9vYmE="},
                                                      {"foobar", "Zm9vYmFy"}};
  for (const auto& [text, code] : vectors) {
    EXPECT_EQ(encoded(text), code);
    EXPECT_EQ(decoded(code), text);
    EXPECT_EQ(decoded(code.substr(0, code.find('='))), text) << "padding may be left out";
  }
}

TEST(Base64, OtherTextsAreNone) {
  for (const char* text :
       {"Z", "Zm9vY", "Z===", "=", "Zm9v=", "Zg==Zg==", "Zm9v\n", "Zm 9", "Zm9-"})
    EXPECT_EQ(decoded(text), "none") << text;
}

TEST(Base64, HighBitsAndBothSpecialLetters) {
  EXPECT_EQ(encoded("\xff\xef\xbe"), "/+++");
  EXPECT_EQ(decoded("/+++"), "\xff\xef\xbe");
  EXPECT_EQ(encoded(std::string_view("\0\0\0", 3)), "AAAA");
}

}  // namespace
}  // namespace luxel
