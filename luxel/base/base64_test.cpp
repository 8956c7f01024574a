#include "luxel/base/base64.h"

#include <gtest/gtest.h>

#include <string_view>

namespace luxel {
namespace {

std::string encoded(std::string_view text) {
  return base64(std::as_bytes(std::span(text.data(), text.size())));
}

// [RFC 4648, section 10]
TEST(Base64, TestVectors) {
  EXPECT_EQ(encoded(""), "");
  EXPECT_EQ(encoded("f"), "Zg==");
  EXPECT_EQ(encoded("fo"), "Zm8=");
  EXPECT_EQ(encoded("foo"), "Zm9v");
  EXPECT_EQ(encoded("foob"), "Zm9vYg==");
  EXPECT_EQ(encoded("fooba"), "Zm9vYmE=");
  EXPECT_EQ(encoded("foobar"), "Zm9vYmFy");
}

TEST(Base64, HighBitsAndBothSpecialLetters) {
  EXPECT_EQ(encoded("\xff\xef\xbe"), "/+++");
  EXPECT_EQ(encoded(std::string_view("\0\0\0", 3)), "AAAA");
}

}  // namespace
}  // namespace luxel
