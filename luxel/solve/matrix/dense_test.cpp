#include "luxel/solve/matrix/dense.h"

#include <gtest/gtest.h>

#include <cmath>

#include "luxel/base/parallel.h"
#include "luxel/solve/matrix/half.h"
#include "luxel/solve/matrix/matrix_test_support.h"

namespace luxel::matrix {
namespace {

std::vector<Rgb> product(const Dense& matrix, std::span<const Rgb> b) {
  std::vector<Rgb> out(b.size());
  DenseScratch scratch = make_dense_scratch(b.size());
  multiply(matrix, b, out, scratch);
  return out;
}

/// Some random entries, of all sizes.
FormFactors random_factors(size_t n) {
  RandomStream random{7};
  FormFactors f;
  f.first.push_back(0);
  for (size_t i = 0; i < n; ++i) {
    for (uint32_t j = 0; j < n; ++j)
      if (random.next() < 0.4f) {
        f.column.push_back(j);
        f.factor.push_back(std::exp(-8 * random.next()) / float(n));
      }
    f.first.push_back(f.column.size());
  }
  return f;
}

TEST(Dense, IsThePlainProduct) {
  // Whole vectors, whole chunks of halves, and what is left over; an odd number of rows.
  for (const size_t n : {1u, 2u, 15u, 33u, 100u, 1029u}) {
    const FormFactors f = random_factors(n);
    const std::vector<Rgb> b = testing::random_light(n, 1), want = testing::plain_product(f, b);
    const std::vector<Rgb> single = product(make_dense(f, Precision::single), b),
                           half = product(make_dense(f, Precision::half), b);
    for (size_t i = 0; i < n; ++i) {
      EXPECT_LE(length(single[i] - want[i]), 1e-6f * length(want[i])) << n;  // sums of floats
      // An entry is off by 2^-11 of itself, or by 2^-25 where it is below 2^-14; light is below 1.
      EXPECT_LE(length(half[i] - want[i]), 0x1p-11f * length(want[i]) + float(n) * 0x1p-25f) << n;
    }
  }
}

TEST(Dense, CountsItsBytes) {
  const FormFactors f = random_factors(30);
  EXPECT_EQ(bytes_of(make_dense(f, Precision::single)), 30u * 30 * 4);
  EXPECT_EQ(bytes_of(make_dense(f, Precision::half)), 30u * 30 * 2);
}

TEST(Dense, SameBitsByAllInstructions) {
  // Halves of all sizes, those below 2^-14 included.
  const size_t n = 1100;
  Dense matrix = make_dense(random_factors(n), Precision::half);
  for (size_t k = 0; k < matrix.half.size(); k += 3) matrix.half[k] = uint16_t(k % 0x7c00);
  const std::vector<Rgb> b = testing::random_light(n, 3);
  std::vector<Rgb> any(n), got(n);
  DenseScratch scratch = make_dense_scratch(n);
  multiply(matrix, b, any, scratch, Instructions::any);
  multiply(matrix, b, got, scratch, instructions());
  EXPECT_EQ(got, any);
}

TEST(Dense, SameBitsForAnyNumberOfThreads) {
  const FormFactors f = random_factors(777);
  const std::vector<Rgb> b = testing::random_light(777, 2);
  for (const Precision precision : {Precision::single, Precision::half}) {
    const Dense matrix = make_dense(f, precision);
    const auto light = [&](int threads) {
      const ThreadLimit limit(threads);
      return product(matrix, b);
    };
    const std::vector<Rgb> one = light(1);
    EXPECT_EQ(one, light(2));
    EXPECT_EQ(one, light(7));
  }
}

TEST(Half, NumbersOfTheStandard) {
  // IEEE 754-2019, table 3.5 and its definition: sign, 5 bits of exponent, 10 of fraction.
  EXPECT_EQ(half_from_float(0), 0x0000);
  EXPECT_EQ(half_from_float(1), 0x3c00);
  EXPECT_EQ(half_from_float(-2), 0xc000);
  EXPECT_EQ(half_from_float(kLargestHalf), 0x7bff);
  EXPECT_EQ(half_from_float(0x1p-14f), 0x0400);  // the least normal one
  EXPECT_EQ(half_from_float(0x1p-24f), 0x0001);  // the least
  EXPECT_EQ(half_from_float(1.0f / 3), 0x3555);
  EXPECT_EQ(half_from_float(1 + 0x1p-11f), 0x3c00);         // a tie, to even
  EXPECT_EQ(half_from_float(1 + 3 * 0x1p-11f), 0x3c02);     // a tie, to even
  EXPECT_EQ(half_from_float(0x1p-14f - 0x1p-26f), 0x0400);  // up into normal ones
  EXPECT_EQ(half_from_float(2 - 0x1p-12f), 0x4000);         // up into the next power
}

TEST(Half, ComeBackAsTheyWere) {
  // All finite halves.
  std::vector<uint16_t> all;
  for (uint32_t h = 0; h < 0x10000; ++h)
    if ((h & 0x7c00) != 0x7c00) all.push_back(uint16_t(h));
  for (const uint16_t h : all) ASSERT_EQ(half_from_float(float_from_half(h)), h);
}

}  // namespace
}  // namespace luxel::matrix
