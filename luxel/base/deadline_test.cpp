#include "luxel/base/deadline.h"

#include <gtest/gtest.h>

namespace luxel {
namespace {

TEST(Deadline, StopsWorkThatTakesTooLong) {
  Progress progress;
  const Clock::time_point start = Clock::now();
  const Deadline deadline(progress, 0.05);
  while (!progress.cancelled() && seconds_since(start) < 10)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  EXPECT_TRUE(progress.cancelled());
  EXPECT_TRUE(deadline.passed());
  EXPECT_GE(seconds_since(start), 0.05);
}

TEST(Deadline, LeavesWorkAloneThatEndsBefore) {
  Progress progress;
  const Clock::time_point start = Clock::now();
  {
    const Deadline deadline(progress, 100);
    EXPECT_FALSE(deadline.passed());
  }
  EXPECT_LT(seconds_since(start), 10);  // the end does not wait for the time
  EXPECT_FALSE(progress.cancelled());
}

}  // namespace
}  // namespace luxel
