#include "luxel/base/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <set>
#include <thread>
#include <vector>

namespace luxel {
namespace {

TEST(ParallelFor, CoversEachIndexOnceInAlignedRanges) {
  for (const int threads : {1, 2, 7}) {
    const ThreadLimit limit(threads);
    for (const size_t count : {size_t(1), size_t(63), size_t(64), size_t(65), size_t(10007)})
      for (const size_t grain : {size_t(1), size_t(64), size_t(20000)}) {
        std::vector<std::atomic<int>> visits(count);
        std::atomic<int> wrong{0};
        parallel_for(count, grain, [&](size_t begin, size_t end) {
          if (begin % grain != 0 || end <= begin || end - begin > grain || end > count) ++wrong;
          for (size_t i = begin; i < end && i < count; ++i) ++visits[i];
        });
        EXPECT_EQ(wrong, 0);
        for (const auto& v : visits) ASSERT_EQ(v, 1) << count << " by " << grain;
      }
  }
}

TEST(ParallelFor, DoesNothingForNothing) {
  parallel_for(0, 16, [](size_t, size_t) { ADD_FAILURE(); });
}

// Ranges are the same however many threads there are, so a sum taken per range and then in order
// has the same bits.
TEST(ParallelFor, SumsPerRangeDoNotDependOnThreads) {
  const auto sum = [](int threads) {
    const ThreadLimit limit(threads);
    constexpr size_t kCount = 100000, kGrain = 512;
    std::vector<float> parts((kCount + kGrain - 1) / kGrain);
    parallel_for(kCount, kGrain, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) parts[begin / kGrain] += 1.0f / float(i + 1);
    });
    float total = 0;
    for (const float p : parts) total += p;
    return total;
  };
  EXPECT_EQ(sum(1), sum(2));
  EXPECT_EQ(sum(1), sum(7));
}

TEST(ParallelFor, FlushesDenormalsInsideAndRestoresThemAfter) {
#if defined(__SSE2__)
  volatile float tiny = 1e-38f;
  std::atomic<int> kept{0};
  parallel_for(64, 1, [&](size_t, size_t) { kept += tiny * 0.01f != 0; });
  EXPECT_EQ(kept, 0);
  EXPECT_NE(tiny * 0.01f, 0);
#else
  GTEST_SKIP() << "only set on processors with SSE2";
#endif
}

TEST(ThreadLimit, LimitsWhileItLives) {
  const int before = thread_count();
  {
    const ThreadLimit one(1);
    EXPECT_EQ(thread_count(), 1);
    std::set<std::thread::id> ids;  // without a lock: one thread
    parallel_for(1000, 1, [&](size_t, size_t) { ids.insert(std::this_thread::get_id()); });
    EXPECT_EQ(ids.size(), 1u);
  }
  EXPECT_EQ(thread_count(), before);
  const ThreadLimit all(0);
  EXPECT_EQ(thread_count(), int(std::thread::hardware_concurrency()));
}

}  // namespace
}  // namespace luxel
