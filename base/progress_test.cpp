#include "base/progress.h"

#include <gtest/gtest.h>

#include <thread>

namespace luxel {
namespace {

TEST(Progress, StartsWithNothing) {
  const Progress progress;
  const Progress::Snapshot s = progress.snapshot();
  EXPECT_EQ(s.stage_index, -1);
  EXPECT_EQ(s.done, 0u);
  EXPECT_TRUE(progress.stages().empty());
  EXPECT_FALSE(progress.cancelled());
}

TEST(Progress, CountsWithinTheRunningStage) {
  Progress progress;
  progress.begin("one", 10);
  progress.advance(3);
  progress.advance(4);
  Progress::Snapshot s = progress.snapshot();
  EXPECT_EQ(s.stage, "one");
  EXPECT_EQ(s.stage_index, 0);
  EXPECT_EQ(s.done, 7u);
  EXPECT_EQ(s.total, 10u);
  progress.begin("two", 5);
  s = progress.snapshot();
  EXPECT_EQ(s.stage, "two");
  EXPECT_EQ(s.stage_index, 1);
  EXPECT_EQ(s.done, 0u) << "a new stage starts at nothing";
  EXPECT_EQ(s.total, 5u);
}

TEST(Progress, KeepsTheSecondsOfFinishedStages) {
  Progress progress;
  progress.begin("slow", 1);
  std::this_thread::sleep_for(std::chrono::milliseconds(30));
  progress.begin("quick", 1);
  progress.finish();
  const double quick = progress.stages()[1].seconds;
  std::this_thread::sleep_for(std::chrono::milliseconds(30));
  progress.finish();  // a second time: nothing to end
  const auto stages = progress.stages();
  ASSERT_EQ(stages.size(), 2u);
  EXPECT_EQ(stages[0].name, "slow");
  EXPECT_GE(stages[0].seconds, 0.03);
  EXPECT_EQ(stages[1].seconds, quick);
  EXPECT_EQ(progress.snapshot().stage_seconds, quick);
}

TEST(Progress, AddsUpAcrossThreads) {
  Progress progress;
  progress.begin("shared", 4000);
  std::vector<std::thread> threads;
  threads.reserve(4);
  for (int t = 0; t < 4; ++t)
    threads.emplace_back([&] {
      for (int i = 0; i < 1000; ++i) progress.advance(1);
    });
  for (std::thread& t : threads) t.join();
  EXPECT_EQ(progress.snapshot().done, 4000u);
}

TEST(Progress, CancelReachesTheWorker) {
  Progress progress;
  std::thread worker([&] {
    while (!progress.cancelled()) std::this_thread::yield();
  });
  progress.request_cancel();
  worker.join();
  EXPECT_TRUE(progress.cancelled());
  progress.begin("after", 1);
  EXPECT_TRUE(progress.cancelled()) << "a new stage does not forget it";
}

}  // namespace
}  // namespace luxel
