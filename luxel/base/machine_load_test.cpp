#include "luxel/base/machine_load.h"

#include <gtest/gtest.h>
#include <pthread.h>
#include <sched.h>

#include <algorithm>
#include <atomic>
#include <ctime>
#include <fstream>
#include <thread>

namespace luxel {
namespace {

/// Works for so many seconds of a processor.
void work_for(double seconds) {
  const auto worked = [] {
    timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
  };
  while (worked() < seconds) {
  }
}

// Two threads share the first processor that the process may use: each waits as long as it works,
// and longer if others want that processor too.
TEST(MachineLoad, IsTwoWhereTwoThreadsShareAProcessor) {
  if (!std::ifstream("/proc/thread-self/schedstat")) GTEST_SKIP() << "the system does not tell";
  cpu_set_t may, one;
  ASSERT_EQ(sched_getaffinity(0, sizeof may, &may), 0);
  int first = 0;
  while (!CPU_ISSET(first, &may)) ++first;
  CPU_ZERO(&one);
  CPU_SET(first, &one);
  std::atomic<int> begun{0};
  double load[2] = {};
  const auto share = [&](int k) {
    pthread_setaffinity_np(pthread_self(), sizeof one, &one);
    ++begun;
    while (begun < 2) std::this_thread::yield();
    work_for(0.1);
    load[k] = machine_load();
  };
  std::thread other(share, 1), own(share, 0);
  own.join(), other.join();
  // The one that ends first has waited for the other one all the time.
  EXPECT_GT(std::max(load[0], load[1]), 1.5);
  EXPECT_GE(std::min(load[0], load[1]), 1);
}

}  // namespace
}  // namespace luxel
