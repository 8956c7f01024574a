// A number that tells bytes apart.
#pragma once

#include <array>
#include <cstring>
#include <span>
#include <string_view>
#include <type_traits>

#include "luxel/base/random.h"

namespace luxel {
inline namespace base {

/// A 64-bit digest of bytes: hash64 over their words of 8 bytes in the machine's order, the last
/// one filled up with zeros, and over their number; many words in four chains side by side, because
/// each step of a chain waits for the one before. Each step is a bijection of the word as of what
/// came before, so that a change within one word is never missed; others are with probability
/// 2^-64. Not safe against people who mean to deceive.
class Digest {
 public:
  void add(std::span<const std::byte> bytes) {
    const size_t count = bytes.size();
    if (bytes.size() >= kMany) bytes = add_in_chains(bytes);
    for (; bytes.size() >= sizeof(uint64_t); bytes = bytes.subspan(sizeof(uint64_t)))
      value_ = hash64(value_ ^ word_at(bytes, 0));
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
  static constexpr size_t kChains = 4, kMany = 256;

  static uint64_t word_at(std::span<const std::byte> bytes, size_t k) {
    uint64_t word;
    std::memcpy(&word, bytes.data() + k * sizeof(word), sizeof(word));
    return word;
  }
  /// Returns what is left, fewer bytes than a step takes.
  std::span<const std::byte> add_in_chains(std::span<const std::byte> bytes) {
    constexpr size_t kStep = kChains * sizeof(uint64_t);
    std::array<uint64_t, kChains> chain;
    for (size_t k = 0; k < kChains; ++k) chain[k] = hash64(value_ ^ k);
    for (; bytes.size() >= kStep; bytes = bytes.subspan(kStep))
      for (size_t k = 0; k < kChains; ++k) chain[k] = hash64(chain[k] ^ word_at(bytes, k));
    for (const uint64_t end : chain) value_ = hash64(value_ ^ end);
    return bytes;
  }

  uint64_t value_ = 0;
};

inline uint64_t digest_of(std::span<const std::byte> bytes) {
  Digest digest;
  digest.add(bytes);
  return digest.value();
}

}  // namespace base
}  // namespace luxel
