// KHR_meshopt_compression's attributes of format 1 and its filter COLOR, byte by byte.
#include "luxel/import/meshopt_attributes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <string>
#include <vector>

namespace luxel::import {
namespace {

using Bytes8 = std::vector<uint8_t>;

/// A stream after its first byte: blocks, then padding, the element before the first, and modes.
Bytes8 stream(Bytes8 blocks, const Bytes8& before, const Bytes8& modes) {
  blocks.resize(blocks.size() + std::max<size_t>(24, before.size() + modes.size()) - before.size() -
                modes.size());
  blocks.insert(blocks.end(), before.begin(), before.end());
  blocks.insert(blocks.end(), modes.begin(), modes.end());
  return blocks;
}

/// Nothing when the stream is refused.
Bytes8 decoded(const Bytes8& bytes, size_t stride, size_t count) {
  Bytes8 out(stride * count);
  return decode_attributes(bytes, stride, out) ? out : Bytes8{};
}

/// Every fourth byte from `first` on.
Bytes8 column(const Bytes8& elements, size_t first) {
  Bytes8 out;
  for (size_t i = first; i < elements.size(); i += 4) out.push_back(elements[i]);
  return out;
}

/// One byte of each element: a running sum that starts at `value` and changes by `deltas` at some
/// elements only.
Bytes8 running(uint8_t value, std::map<size_t, int> deltas, size_t count) {
  Bytes8 out;
  for (size_t i = 0; i < count; ++i) out.push_back(value = uint8_t(value + deltas[i]));
  return out;
}

Bytes8 joined(const std::vector<Bytes8>& parts) {
  Bytes8 out;
  for (const Bytes8& part : parts) out.insert(out.end(), part.begin(), part.end());
  return out;
}

TEST(MeshoptAttributes, TheSpecificationsExample) {
  // Control 0 with widths of 4 bits for the first byte, nothing for the others.
  const Bytes8 elements =
      decoded(stream({0xa8, 3, 0x17, 0x5f, 0xf0, 0xbc, 0x77, 0xa9, 0x21, 0x00, 0x34, 0xb5},
                     {0, 7, 8, 9}, {0}),
              4, 16);
  ASSERT_EQ(elements.size(), 64u);
  const int deltas[] = {-1, -4, -3, 26, -91, 0, -6, 6, -4, -4, 5, -5, 1, -1, 0, 0};
  int sum = 0;
  for (size_t i = 0; i < 16; ++i) EXPECT_EQ(elements[4 * i], uint8_t(sum += deltas[i])) << i;
  for (size_t k = 1; k < 4; ++k) EXPECT_EQ(column(elements, k), Bytes8(16, uint8_t(6 + k)));
}

// 56 elements are four groups, the last of which is half full; each of a group's 16 deltas is there
// nevertheless, but not where they are plain bytes.
Bytes8 every_control() {
  const Bytes8 zeros2(2), zeros3(3), zeros7(7);
  Bytes8 plain(56);
  plain[0] = 2, plain[55] = 3;
  return stream(joined({{0 | 1 << 2 | 2 << 4 | 3 << 6},  // controls
                                                         // Control 0: no bits, 1, 2 and 4.
                        {0xe4},
                        {0x01, 0x80, 4, 3},
                        {0b01100011, 0, 0, 0, 10},
                        {0x12, 0xf0, 0, 0, 0, 0, 0, 0x50, 32},
                        // Control 1: 1 bit, 2, 4 and 8.
                        {0xe4},
                        {0x02, 0, 1},
                        {0b10000000, 0, 0, 0},
                        {0, 0, 0, 0, 0, 0, 0, 0x05},
                        {0xff, 0, 0, 0, 0, 0, 0, 2, 0x77, 0x77, 0x77, 0x77, 0x77, 0x77, 0x77, 0x77},
                        // Control 2 has no bytes; control 3 has the deltas as they are.
                        plain}),
                {10, 20, 30, 40}, {0});
}

TEST(MeshoptAttributes, EveryControlAndWidth) {
  const Bytes8 elements = decoded(every_control(), 4, 56);
  ASSERT_EQ(elements.size(), 4 * 56u);
  EXPECT_EQ(
      column(elements, 0),
      running(10, {{16, 2}, {31, -2}, {32, -1}, {33, 1}, {35, 5}, {48, -1}, {49, 1}, {50, 16}},
              56));
  EXPECT_EQ(column(elements, 1),
            running(20, {{1, -1}, {16, 1}, {47, -3}, {48, -128}, {55, 1}}, 56));
  EXPECT_EQ(column(elements, 2), Bytes8(56, 30));
  EXPECT_EQ(column(elements, 3), running(40, {{0, 1}, {55, -2}}, 56));
}

TEST(MeshoptAttributes, EveryChannelMode) {
  const Bytes8 modes = {0, 1, 0x42}, controls = {0xff, 0xff, 0xff};
  // Two elements: bytes with no carry, 16 bits with one, and the exclusive or, turned left by 4.
  const Bytes8 deltas = {20,   0, 0, 0, 0, 0, 0, 1,  //
                         2,    1, 0, 0, 1, 0, 0, 0,  //
                         0x18, 0, 0, 0, 0, 0, 0, 0x0f};
  const Bytes8 before = {250, 2, 3, 4, 0xff, 0, 0, 0, 0x0f, 0x0f, 0x0f, 0x0f};
  const Bytes8 expected = {
      // 250 + 10 = 4; 0x00ff + 1 and 0 - 1; 0x0f0f0f0f with the bits 0x80000001.
      4, 2, 3, 4, 0, 1, 0xff, 0xff, 0x0e, 0x0f, 0x0f, 0x8f,
      // 4 - 1 in the last byte; 0x0100 - 1; with the bits 0x00f00000 (0x0f000000 turned back).
      4, 2, 3, 3, 0xff, 0, 0xff, 0xff, 0x0e, 0x0f, 0xff, 0x8f};
  EXPECT_EQ(decoded(stream(joined({controls, deltas}), before, modes), 12, 2), expected);
}

// A block has 8192 bytes in whole groups of 16 elements, and 256 elements at most; it has controls
// of its own, and goes on from the last element of the one before.
TEST(MeshoptAttributes, BlocksFollowEachOther) {
  for (const auto& [stride, first] : std::map<size_t, size_t>{{64, 128}, {36, 224}, {4, 256}}) {
    const size_t count = first + 72;
    Bytes8 controls(stride / 4, 0xaa);  // no deltas
    Bytes8 with_plain = controls, plain(first), rest(72);
    with_plain[0] = 0xab;
    plain.back() = 8, rest[1] = 2;
    const Bytes8 bytes = stream(joined({with_plain, plain, with_plain, rest}), Bytes8(stride, 50),
                                Bytes8(stride / 4));
    Bytes8 expected(stride * count, 50);
    const Bytes8 byte_0 = running(50, {{first - 1, 4}, {first + 1, 1}}, count);
    for (size_t i = 0; i < count; ++i) expected[i * stride] = byte_0[i];
    EXPECT_EQ(decoded(bytes, stride, count), expected) << stride;
  }
}

TEST(MeshoptAttributes, DamageIsSeen) {
  const Bytes8 good = every_control();
  ASSERT_FALSE(decoded(good, 4, 56).empty());
  for (size_t length = 0; length < good.size(); ++length)
    EXPECT_TRUE(decoded({good.begin(), good.begin() + ptrdiff_t(length)}, 4, 56).empty()) << length;
  // Other counts have other lengths, and so has a stream with a byte more.
  EXPECT_TRUE(decoded(good, 4, 55).empty());
  EXPECT_TRUE(decoded(good, 4, 57).empty());
  Bytes8 longer = good;
  longer.insert(longer.begin() + 1, 0);
  EXPECT_TRUE(decoded(longer, 4, 56).empty());
  for (const int mode : {3, 15, 0x10, 0x11, 0xf0}) {
    Bytes8 bad = good;
    bad.back() = uint8_t(mode);
    EXPECT_TRUE(decoded(bad, 4, 56).empty()) << mode;
  }
}

/// The filter's rows of numbers, and what they become.
void expect_colors(size_t stride, std::vector<int> rows, const std::vector<int>& colors) {
  Bytes8 bytes;
  for (const int v : rows)
    for (size_t k = 0; k < stride / 4; ++k) bytes.push_back(uint8_t(v >> (8 * k)));
  decode_colors(stride, bytes);
  for (size_t i = 0; i < colors.size(); ++i)
    EXPECT_EQ(stride == 4 ? bytes[i] : bytes[2 * i] | bytes[2 * i + 1] << 8, colors[i]) << i;
}

// Y = (R + 2 G + B) / 4, Co = (R - B) / 2, Cg = G - Y.
TEST(MeshoptColors, OfEveryWidth) {
  // Eight bits, (200, 50, 100); alpha has seven, and its last one twice.
  expect_colors(4, {100, 50, -50, 0x80 | 64, 100, 50, -50, 0xff, 0, 0, 0, 0x80},
                {200, 50, 100, 128, 200, 50, 100, 255, 0, 0, 0, 0});
  // Four bits, (8, 2, 4) of 15: times 17; alpha 1011 of 15.
  expect_colors(4, {4, 2, -2, 0b1101}, {136, 34, 68, 187});
  // Two bits, the fewest: (3, 3, 0) of 3 has no luma in whole numbers, (3, 1, 3) has.
  expect_colors(4, {2, 0, -1, 0b11}, {255, 85, 255, 255});
  expect_colors(8, {25700, 12850, -12850, 0x8000 | 0x4000}, {51400, 12850, 25700, 32768});
  // Twelve bits, (2000, 500, 1000) of 4095: times 65535 / 4095.
  expect_colors(8, {1000, 500, -500, 0x800 | 2047}, {32007, 8002, 16004, 65535});
}

// Nothing says how many bits these have, or they lie outside of what these bits hold.
TEST(MeshoptColors, DamagedOnesAreBlackOrAtTheEdge) {
  expect_colors(4, {100, 50, -50, 0}, {0, 0, 0, 0});
  expect_colors(4, {15, 0, 7, 0b1111}, {136, 255, 136, 255});
  expect_colors(8, {0, -32768, 0, 0xffff}, {0, 0, 32768, 65535});
}

}  // namespace
}  // namespace luxel::import
