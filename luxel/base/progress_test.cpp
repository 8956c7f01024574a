#include "luxel/base/progress.h"

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
  // Sleeping takes at least as long as it is asked to: a busy machine cannot fail this.
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

// 10 s were expected and took 20; a quarter of all 40 s counts as expected. So 20 s take 30.
TEST(SecondsLeft, FollowFromWhatTheWorkHasTakenSoFar) {
  EXPECT_DOUBLE_EQ(seconds_left({10, 10, 0, 0, 0, 30}), 30);
  EXPECT_DOUBLE_EQ(seconds_left({10, 20, 0, 0, 0, 30}), 30 * 1.5);
  // A stage of 10 s that has just begun, and 30 s after it: 12.5 of 50 s count as expected.
  EXPECT_DOUBLE_EQ(seconds_left({10, 20, 10, 0, 0, 30}), 40 * 32.5 / 22.5);
  EXPECT_DOUBLE_EQ(seconds_left({0, 0, 10, 4, 0, 0}), 6) << "no share is known: as was expected";
}

// A stage that ended at once, or took a hundred times its tenth of a millisecond, is no measure of
// the 100 s that are to come.
TEST(SecondsLeft, DoNotFollowFromTheFirstMoments) {
  EXPECT_NEAR(seconds_left({1e-4, 0, 10, 0, 0, 90}), 100, 0.1);
  EXPECT_NEAR(seconds_left({1e-4, 1e-2, 10, 0, 0, 90}), 100, 0.1);
}

// Half of a stage of 10 s took 20 s: it will take 40. With a quarter of the 15 s as expected, what
// follows is 43.75 / 13.75 times as slow.
TEST(SecondsLeft, FollowFromTheSpeedOfTheRunningStage) {
  EXPECT_DOUBLE_EQ(seconds_left({0, 0, 10, 20, 0.5, 5}), 20 + 5 * 43.75 / 13.75);
  EXPECT_DOUBLE_EQ(seconds_left({0, 0, 10, 30, 0, 0}), 0) << "never below nothing";
  // An eighth took 0.5 s of 10: half of what counts says 4 s, the other half 10.
  EXPECT_DOUBLE_EQ(seconds_left({0, 0, 10, 0.5, 0.125, 0}), 6.5);
}

TEST(Progress, ExpectedStagesAreTakenAwayAsTheyCome) {
  Progress progress;
  EXPECT_LT(progress.snapshot().seconds_left, 0) << "nothing is expected";
  progress.expect_at_end({{"write", 100}});
  progress.expect({{"trace", 1000}, {"bounce", 1000}});
  progress.begin("read", 0);
  EXPECT_DOUBLE_EQ(progress.snapshot().seconds_left, 2100);
  progress.begin("trace", 10);
  EXPECT_NEAR(progress.snapshot().seconds_left, 2100, 1);
  progress.expect({{"bounce", 500}});  // said anew
  EXPECT_NEAR(progress.snapshot().seconds_left, 1600, 1);
  // The trace of 1,000 s took none; a quarter of 1,100 s counts as expected.
  progress.begin("write", 10);
  EXPECT_NEAR(progress.snapshot().seconds_left, 100 * 275.0 / 1275, 1) << "no bounces any more";
}

// No plan says what comes before the end: it is known when it begins.
TEST(Progress, TheEndAloneIsNotTheWhole) {
  Progress progress;
  progress.expect_at_end({{"draw", 50}, {"write", 100}});
  progress.begin("trace", 10);
  EXPECT_LT(progress.snapshot().seconds_left, 0);
  progress.begin("draw", 10);
  EXPECT_NEAR(progress.snapshot().seconds_left, 150, 1);
}

// Stages of rounds come as they may: time runs on until the end is there.
TEST(Progress, ATimeIsExpectedWhateverComes) {
  Progress progress;
  progress.expect_at_end({{"write", 100}});
  progress.expect_within(1000);
  progress.begin("trace", 10);
  EXPECT_NEAR(progress.snapshot().seconds_left, 1100, 1);
  const double before = progress.snapshot().seconds_left;
  std::this_thread::sleep_for(std::chrono::milliseconds(5));  // at least
  EXPECT_LE(progress.snapshot().seconds_left, before - 0.005);
  progress.begin("write", 10);
  EXPECT_NEAR(progress.snapshot().seconds_left, 100, 1);
}

// Half of the stage was there already: what is left takes half as long, and goes at its own speed.
TEST(Progress, WhatIsSkippedIsDoneButTakesNoTime) {
  Progress progress;
  progress.expect({{"trace", 1000}});
  progress.begin("trace", 100);
  progress.skip(50);
  EXPECT_EQ(progress.snapshot().done, 50u);
  EXPECT_EQ(progress.snapshot().skipped, 50u);
  EXPECT_NEAR(progress.snapshot().seconds_left, 500, 1);
  progress.begin("next", 10);
  EXPECT_EQ(progress.snapshot().skipped, 0u);
}

// 1 s of 100 s, and then 1 s of 1000 s: what was shown stays. In the end all is done.
TEST(Progress, TheShareOfAllWorkNeverFalls) {
  Progress progress;
  progress.begin("read", 4);
  progress.advance(1);
  EXPECT_DOUBLE_EQ(progress.snapshot().share, 0.25) << "nothing is expected: that of the stage";
  std::this_thread::sleep_for(std::chrono::milliseconds(20));  // at least
  progress.expect({{"trace", 0.2}, {"write", 0.1}});
  const double shown = progress.snapshot().share;
  EXPECT_GT(shown, 0.02 / (0.02 + 0.3) - 0.01);
  progress.expect({{"trace", 1000}, {"write", 0.1}});
  EXPECT_GE(progress.snapshot().share, shown);
  EXPECT_NEAR(progress.snapshot().share, shown, 0.01);
  progress.begin("trace", 0);
  progress.begin("write", 0);
  progress.finish();
  EXPECT_DOUBLE_EQ(progress.snapshot().seconds_left, 0);
  EXPECT_DOUBLE_EQ(progress.snapshot().share, 1);
}

// A stage in parts is one stage; another of its name that is the next to come is another.
TEST(Progress, AStageGoesOnUnderItsName) {
  Progress progress;
  progress.expect({{"draw", 1000}, {"draw", 100}, {"write", 10}});
  progress.begin("draw", 10);
  progress.begin("draw", 10);
  EXPECT_EQ(progress.stages().size(), 2u) << "the second one was expected";
  progress.advance(10);
  progress.begin("draw", 30);
  EXPECT_EQ(progress.snapshot().done, 10u) << "that goes on";
  EXPECT_EQ(progress.snapshot().total, 40u);
  progress.finish();
  progress.begin("draw", 0);
  EXPECT_EQ(progress.stages().size(), 2u);
  progress.begin("write", 0);
  EXPECT_EQ(progress.stages().size(), 3u);
}

// 100 s were expected and took none; what is told after that is known better.
TEST(Progress, WhatIsToldAnewCountsAsItIs) {
  Progress progress;
  progress.expect({{"lay out", 100}, {"trace", 50}});
  progress.begin("lay out", 0);
  progress.begin("trial", 0);
  progress.expect({{"trace", 50}});
  EXPECT_DOUBLE_EQ(progress.snapshot().seconds_left, 50);
}

TEST(Progress, CarriesWhatIsToBeSaidAndDone) {
  Progress progress;
  EXPECT_EQ(progress.way_on(), "");
  progress.clean_up();  // nothing to do
  progress.note("one"), progress.note("two");
  EXPECT_EQ(progress.notes(0), (std::vector<std::string>{"one", "two"}));
  EXPECT_EQ(progress.notes(1), std::vector<std::string>{"two"});
  EXPECT_TRUE(progress.notes(2).empty());
  progress.set_way_on("there");
  EXPECT_EQ(progress.way_on(), "there");
  int cleaned = 0;
  progress.set_clean_up([&] { ++cleaned; });
  progress.clean_up();
  EXPECT_EQ(cleaned, 1);
}

}  // namespace
}  // namespace luxel
