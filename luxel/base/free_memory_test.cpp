#include "luxel/base/free_memory.h"

#include <gtest/gtest.h>

namespace luxel {
namespace {

TEST(FreeMemory, LeavesNoCapacity) {
  std::vector<int> values(1000);
  free_memory(values);
  EXPECT_TRUE(values.empty());
  EXPECT_EQ(values.capacity(), 0u);
}

}  // namespace
}  // namespace luxel
