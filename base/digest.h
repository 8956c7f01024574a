// A number that tells bytes apart.
#pragma once

#include <cstring>
#include <span>
#include <string_view>
#include <type_traits>

#include "base/random.h"

namespace luxel {
inline namespace base {

/// A 64-bit digest of bytes: hash64 over their words of 8 bytes in the machine's order, the last
/// one filled up with zeros, and over their number. Each step is a bijection of the word as of what
/// came before, so that a change within one word is never missed; others are with probability
/// 2^-64. Not safe against people who mean to deceive.
class Digest {
 public:
  void add(std::span<const std::byte> bytes) {
    const size_t count = bytes.size();
    for (; bytes.size() >= sizeof(uint64_t); bytes = bytes.subspan(sizeof(uint64_t))) {
      uint64_t word;
      std::memcpy(&word, bytes.data(), sizeof(word));
      value_ = hash64(value_ ^ word);
    }
    uint64_t rest = 0;
    if (!bytes.empty()) std::memcpy(&rest, bytes.data(), bytes.size());
    value_ = hash64(value_ ^ rest);
    value_ = hash64(value_ ^ count);
  }
  void add(std::string_view text) { add(std::as_bytes(std::span(text))); }
  /// Numbers, and structs of numbers without gaps between them: a gap's bytes may be anything.
  template <class T>
  void add(std::span<const T> values) {
    static_assert(std::is_trivially_copyable_v<T>);
    add(std::as_bytes(values));
  }
  template <class T>
  requires std::is_arithmetic_v<T> || std::is_enum_v<T>
  void add(T value) { add(std::span<const T>(&value, 1)); }

  uint64_t value() const { return value_; }

 private:
  uint64_t value_ = 0;
};

inline uint64_t digest_of(std::span<const std::byte> bytes) {
  Digest digest;
  digest.add(bytes);
  return digest.value();
}

}  // namespace base
}  // namespace luxel
