#include "luxel/base/sha256.h"

#include <bit>
#include <cmath>
#include <cstdint>
#include <string>

namespace luxel {
inline namespace base {
namespace {

using Words = std::array<uint32_t, 8>;

/// The first 32 bits of the fraction of each of the first 64 primes' roots [FIPS 180-4, sections
/// 4.2.2 and 5.3.3]. A double has 48 bits behind the point of a root below 18.
template <class Root>
std::array<uint32_t, 64> fractions(const Root& root) {
  std::array<uint32_t, 64> out;
  size_t count = 0;
  for (unsigned n = 2; count < out.size(); ++n) {
    bool is_prime = true;
    for (unsigned d = 2; d * d <= n; ++d) is_prime = is_prime && n % d != 0;
    if (!is_prime) continue;
    const double r = root(double(n));
    out[count++] = uint32_t((r - std::floor(r)) * 0x1p32);
  }
  return out;
}

uint32_t word_at(std::string_view bytes, size_t at) {
  uint32_t word = 0;
  for (size_t i = 0; i < 4; ++i) word = word << 8 | static_cast<unsigned char>(bytes[at + i]);
  return word;
}

/// A block of 64 bytes [FIPS 180-4, section 6.2.2].
void add_block(std::string_view block, const std::array<uint32_t, 64>& k, Words& hash) {
  std::array<uint32_t, 64> w;
  for (size_t t = 0; t < 16; ++t) w[t] = word_at(block, 4 * t);
  for (size_t t = 16; t < 64; ++t) {
    const uint32_t a = w[t - 15], b = w[t - 2];
    w[t] = (std::rotr(b, 17) ^ std::rotr(b, 19) ^ b >> 10) + w[t - 7] +
           (std::rotr(a, 7) ^ std::rotr(a, 18) ^ a >> 3) + w[t - 16];
  }
  Words s = hash;  // a to h
  for (size_t t = 0; t < 64; ++t) {
    const uint32_t choice = (s[4] & s[5]) ^ (~s[4] & s[6]),
                   majority = (s[0] & s[1]) ^ (s[0] & s[2]) ^ (s[1] & s[2]),
                   t1 = s[7] + (std::rotr(s[4], 6) ^ std::rotr(s[4], 11) ^ std::rotr(s[4], 25)) +
                        choice + k[t] + w[t],
                   t2 = (std::rotr(s[0], 2) ^ std::rotr(s[0], 13) ^ std::rotr(s[0], 22)) + majority;
    s = {t1 + t2, s[0], s[1], s[2], s[3] + t1, s[4], s[5], s[6]};
  }
  for (size_t i = 0; i < 8; ++i) hash[i] += s[i];
}

}  // namespace

std::array<std::byte, 32> sha256(std::string_view text) {
  const auto k = fractions([](double n) { return std::cbrt(n); });
  const auto roots = fractions([](double n) { return std::sqrt(n); });
  // Behind the text a bit of 1, zeros, and the number of bits fill the last block.
  std::string padded = std::string(text) + '\x80';
  padded.resize((padded.size() + 8 + 63) / 64 * 64);
  for (size_t i = 0; i < 8; ++i)
    padded[padded.size() - 1 - i] = char(uint64_t(text.size()) * 8 >> (8 * i));
  Words hash;
  for (size_t i = 0; i < 8; ++i) hash[i] = roots[i];
  for (size_t at = 0; at < padded.size(); at += 64)
    add_block(std::string_view(padded).substr(at, 64), k, hash);
  std::array<std::byte, 32> out;
  for (size_t i = 0; i < 32; ++i) out[i] = std::byte(hash[i / 4] >> (24 - 8 * (i % 4)));
  return out;
}

}  // namespace base
}  // namespace luxel
