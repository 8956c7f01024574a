#include "luxel/base/sha256.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace luxel {
namespace {

std::string hex_of(const std::string& text) {
  std::string out;
  for (const std::byte b : sha256(text)) out += fmt::format("{:02x}", unsigned(b));
  return out;
}

// The examples of the National Institute of Standards and Technology: one block, two, and many.
TEST(Sha256, KnownTexts) {
  EXPECT_EQ(hex_of(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(hex_of("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(hex_of("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  EXPECT_EQ(hex_of(std::string(1'000'000, 'a')),
            "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

}  // namespace
}  // namespace luxel
