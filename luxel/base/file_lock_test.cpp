#include "luxel/base/file_lock.h"

#include <gmock/gmock.h>

#include "tests/scratch_folder.h"

namespace luxel {
namespace {

// flock() tells apart who has opened a file, also within one process.
TEST(FileLock, IsHeldByOneAtATime) {
  const testing_support::ScratchFolder s;
  const std::filesystem::path file = s.path / "lock";
  {
    const auto first = FileLock::take(file, "the work");
    ASSERT_TRUE(first) << first.error().message;
    const auto second = FileLock::take(file, "the work");
    ASSERT_FALSE(second);
    EXPECT_THAT(second.error().message,
                ::testing::HasSubstr("another process is using the work; wait"));
    EXPECT_TRUE(std::filesystem::exists(file));
  }
  EXPECT_FALSE(std::filesystem::exists(file)) << "nothing of it stays";
  EXPECT_TRUE(FileLock::take(file, "the work"));
  EXPECT_FALSE(FileLock::take(s.path / "absent" / "lock", "the work"));
}

}  // namespace
}  // namespace luxel
