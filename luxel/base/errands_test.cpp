#include "luxel/base/errands.h"

#include <gtest/gtest.h>

#include <stdexcept>

#ifdef __linux__
#include <sys/resource.h>
#endif

#include "luxel/base/thread_priority.h"

namespace luxel {
namespace {

TEST(Errands, AreRunByAnotherThreadOneAfterTheOther) {
  Errands errands;
  std::thread::id first, second;
  errands.run([&] { first = std::this_thread::get_id(); });
  errands.run([&] { second = std::this_thread::get_id(); });
  EXPECT_EQ(first, second);
  EXPECT_NE(first, std::this_thread::get_id());
  EXPECT_THROW(errands.run([] { throw std::runtime_error("no"); }), std::runtime_error);
  errands.run([&] { first = {}; });
  EXPECT_EQ(first, std::thread::id());
}

#ifdef __linux__
TEST(Errands, KeepThePriorityOfWhoMadeThem) {
  Errands errands;
  int of_worker = 0, of_errand = 0;
  std::thread([&] {
    lower_priority_of_this_thread();
    of_worker = getpriority(PRIO_PROCESS, 0);
    errands.run([&] { of_errand = getpriority(PRIO_PROCESS, 0); });
  }).join();
  EXPECT_EQ(of_errand, getpriority(PRIO_PROCESS, 0));
  EXPECT_GT(of_worker, of_errand);
}
#endif

}  // namespace
}  // namespace luxel
