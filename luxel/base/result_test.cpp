#include "luxel/base/result.h"

#include <gtest/gtest.h>

#include <memory>

#include "luxel/base/check.h"

namespace luxel {
namespace {

Result<int> positive(int value) {
  if (value <= 0) return fail(ErrorCode::bad_setting, "{} is not positive", value);
  return value;
}

Status positive_status(int value) {
  LUXEL_TRY([[maybe_unused]] const int same, positive(value));
  return {};
}

Result<int> sum(int a, int b, int& evaluations) {
  LUXEL_TRY(const int x, (++evaluations, positive(a)));
  LUXEL_TRY(const int y, (++evaluations, positive(b)));
  LUXEL_TRY_STATUS((++evaluations, positive_status(x + y)));
  return x + y;
}

TEST(Result, FailFormatsTheSentence) {
  const Result<int> r = positive(-3);
  ASSERT_FALSE(r);
  EXPECT_EQ(r.error().code, ErrorCode::bad_setting);
  EXPECT_EQ(r.error().message, "-3 is not positive");
}

TEST(Result, TryDeclaresTheValueAndEvaluatesOnce) {
  int evaluations = 0;
  const Result<int> r = sum(2, 3, evaluations);
  ASSERT_TRUE(r);
  EXPECT_EQ(*r, 5);
  EXPECT_EQ(evaluations, 3);
}

TEST(Result, TryReturnsTheFirstErrorAtOnce) {
  int evaluations = 0;
  const Result<int> r = sum(0, -1, evaluations);
  ASSERT_FALSE(r);
  EXPECT_EQ(r.error().message, "0 is not positive");
  EXPECT_EQ(evaluations, 1);
}

TEST(Result, TryStatusPassesTheErrorOn) {
  EXPECT_TRUE(positive_status(1));
  const Status s = positive_status(-7);
  ASSERT_FALSE(s);
  EXPECT_EQ(s.error().message, "-7 is not positive");
}

Result<std::unique_ptr<int>> boxed(int value) { return std::make_unique<int>(value); }
Result<int> unboxed(int value) {
  LUXEL_TRY(std::unique_ptr<int> box, boxed(value));
  LUXEL_TRY(*box, positive(*box + 1));  // assigns to what is there
  return *box;
}

TEST(Result, TryMovesTheValueAndCanAssign) { EXPECT_EQ(*unboxed(4), 5); }

TEST(CheckDeathTest, SaysWhichContractBroke) {
  LUXEL_CHECK(1 + 1 == 2);
  EXPECT_DEATH(LUXEL_CHECK(1 + 1 == 3), "1 \\+ 1 == 3 does not hold .*result_test.cpp");
}

}  // namespace
}  // namespace luxel
