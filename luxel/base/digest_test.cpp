#include "luxel/base/digest.h"

#include <gtest/gtest.h>

#include <set>
#include <vector>

namespace luxel {
namespace {

uint64_t digest(const std::vector<std::byte>& bytes) { return digest_of(bytes); }

TEST(Digest, ChangesWithEveryBitAndWithTheLength) {
  std::set<uint64_t> seen;
  size_t count = 0;
  // Short ones, and those that are long enough for chains side by side.
  for (size_t length = 0; length <= 300; length += length == 20 ? 240 : 1) {
    std::vector<std::byte> bytes(length);
    seen.insert(digest(bytes)), ++count;  // zeros: the length alone differs
    for (size_t i = 0; i < 8 * length; ++i, ++count) {
      bytes[i / 8] ^= std::byte(1 << i % 8);
      seen.insert(digest(bytes));
      bytes[i / 8] ^= std::byte(1 << i % 8);
    }
  }
  EXPECT_EQ(seen.size(), count);
}

TEST(Digest, ChangesWhenWordsChangePlaces) {
  std::vector<uint64_t> words(64);
  for (size_t k = 0; k < words.size(); ++k) words[k] = 1000 + k;
  std::set<uint64_t> seen{digest_of(std::as_bytes(std::span(words)))};
  for (size_t k = 1; k < words.size(); ++k) {
    std::swap(words[0], words[k]);
    seen.insert(digest_of(std::as_bytes(std::span(words))));
    std::swap(words[0], words[k]);
  }
  EXPECT_EQ(seen.size(), words.size());
}

TEST(Digest, KnowsWhereOneListEndsAndTheNextBegins) {
  Digest a, b;
  a.add("ab"), a.add("c");
  b.add("a"), b.add("bc");
  EXPECT_NE(a.value(), b.value());
}

}  // namespace
}  // namespace luxel
