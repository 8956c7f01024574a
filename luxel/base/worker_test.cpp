#include "luxel/base/worker.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <string>

namespace luxel {
namespace {

void sleep_ms(int milliseconds) {
  std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
}

/// Text of the results: an error's is in brackets.
template <class W>
std::vector<std::string> taken(W& worker) {
  std::vector<std::string> out;
  for (const Result<std::string>& result : worker.take())
    out.push_back(result ? *result : "(" + result.error().message + ")");
  return out;
}

using Words = Worker<std::string, std::string>;

TEST(Worker, HandsOverManyResultsAndKeepsItsState) {
  Words worker([count = 0](const std::string& word, const Words::Hand& hand, Progress&) mutable {
    for (int k = 0; k < 2; ++k) hand(word + std::to_string(++count));
    return Status();
  });
  EXPECT_FALSE(worker.is_busy());
  worker.ask("a");
  worker.wait();
  EXPECT_TRUE(worker.is_busy()) << "there is something to take";
  EXPECT_THAT(taken(worker), ::testing::ElementsAre("a1", "a2"));
  EXPECT_FALSE(worker.is_busy());
  worker.ask("b");
  worker.wait();
  EXPECT_THAT(taken(worker), ::testing::ElementsAre("b3", "b4"));
}

/// A result that takes in newer ones.
struct Tally {
  int sum = 0;
};
void merge(Tally newer, Tally& last) { last.sum += newer.sum; }

TEST(Worker, MergesResultsThatNobodyHasTaken) {
  Worker<int, Tally> worker([](int count, const auto& hand, Progress&) {
    for (int k = 0; k < count; ++k) hand(Tally{1});
    return Status();
  });
  for (int round = 0; round < 2; ++round) {
    worker.ask(5);
    worker.wait();
    const auto come = worker.take();
    ASSERT_EQ(come.size(), 1u);
    EXPECT_EQ(come[0]->sum, 5);
  }
}

TEST(Worker, DoesTheNewestRequest) {
  std::atomic<int> begun = 0;
  Words worker([&](const std::string& word, const Words::Hand& hand, Progress& progress) -> Status {
    ++begun, begun.notify_all();
    hand(word + " begins");
    while (word == "slow" && !progress.cancelled()) sleep_ms(1);
    if (word == "slow" && begun == 1) return stopped(progress);
    hand(word + " ends");
    return Status();
  });
  worker.ask("slow");
  begun.wait(0);
  worker.ask("dropped"), worker.ask("quick");
  worker.wait();
  EXPECT_THAT(taken(worker), ::testing::ElementsAre("slow begins", "quick begins", "quick ends"));
  worker.ask("slow");
  begun.wait(2);
  worker.forget();
  worker.wait();
  EXPECT_THAT(taken(worker), ::testing::IsEmpty()) << "though it has handed over its end";
  worker.ask("slow");  // the destructor ends it
}

TEST(Worker, TellsErrorsAndNoMemory) {
  Words worker([](const std::string& word, const Words::Hand& hand, Progress&) -> Status {
    hand(word);
    if (word == "large") throw std::bad_alloc();
    return fail(ErrorCode::io, "no disk");
  });
  worker.ask("small");
  worker.wait();
  EXPECT_THAT(taken(worker), ::testing::ElementsAre("small", "(no disk)"));
  worker.ask("large");
  worker.wait();
  EXPECT_THAT(taken(worker), ::testing::ElementsAre("large", "(out of memory)"));
}

TEST(Worker, IsHeldAndGoesOn) {
  std::atomic<int> steps = 0;
  Worker<int, int> worker([&](int most, const auto&, Progress& progress) {
    progress.begin("count", uint64_t(most));
    for (; steps < most && !progress.cancelled(); ++steps) progress.advance(1), sleep_ms(1);
    return Status();
  });
  worker.ask(100000);
  while (steps == 0) sleep_ms(1);
  EXPECT_EQ(worker.snapshot().stage, "count");
  worker.set_paused(true);
  sleep_ms(20);  // a step that had begun
  const int held = steps;
  sleep_ms(20);
  EXPECT_EQ(steps, held);
  worker.set_paused(false);
  while (steps == held) sleep_ms(1);
}

}  // namespace
}  // namespace luxel
