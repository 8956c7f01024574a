#include "luxel/base/mapped_memory.h"

#include <gtest/gtest.h>

#include <numeric>
#include <thread>

#include "luxel/base/free_memory.h"
#include "luxel/base/process_memory.h"

namespace luxel {
namespace {

constexpr size_t kNumbers = 8 << 20;  ///< 32 MiB of numbers

std::shared_ptr<MappedMemory> memory_in(const std::filesystem::path& folder,
                                        uint64_t most_resident_bytes = UINT64_MAX) {
  return std::make_shared<MappedMemory>(folder, most_resident_bytes);
}

MappedVector<uint32_t> counted(std::shared_ptr<MappedMemory> memory, size_t count = kNumbers) {
  MappedVector<uint32_t> out(count, 0, MappedAllocator<uint32_t>(std::move(memory)));
  std::iota(out.begin(), out.end(), 7u);
  return out;
}

bool is_counted(const MappedVector<uint32_t>& v, size_t count = kNumbers) {
  for (size_t i = 0; i < v.size(); ++i)
    if (v[i] != uint32_t(i + 7)) return false;
  return v.size() == count;
}

TEST(MappedMemory, KeepsWhatIsLetGoOf) {
  const auto memory = memory_in(testing::TempDir());
  const MappedVector<uint32_t> v = counted(memory);
  ASSERT_TRUE(memory->holds(v.data()));
  const uint64_t before = resident_bytes();
  memory->let_go();
  // All of its pages but few are gone; others of the process change by less.
  EXPECT_LT(resident_bytes() + kNumbers * sizeof(uint32_t) / 2, before);
  EXPECT_TRUE(is_counted(v));
}

TEST(MappedMemory, LetsGoWhileTooMuchIsHeld) {
  constexpr size_t kMany = 24 << 20;  // 96 MiB: less is not worth letting go of
  const auto memory = memory_in(testing::TempDir(), 1);
  const MappedVector<uint32_t> v = counted(memory, kMany);
  // A look may come at any time: once in many times one falls between the two numbers.
  bool went = false;
  for (int k = 0; k < 50 && !went; ++k) {
    EXPECT_TRUE(is_counted(v, kMany));
    const uint64_t before = resident_bytes();
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    went = resident_bytes() + kMany < before;
  }
  EXPECT_TRUE(went);
  EXPECT_TRUE(is_counted(v, kMany));
}

TEST(MappedMemory, MovesAlongWithItsVector) {
  const auto memory = memory_in(testing::TempDir());
  MappedVector<uint32_t> v = counted(memory), other;
  const uint32_t* const place = v.data();
  other = std::move(v);
  EXPECT_EQ(other.data(), place);
  EXPECT_TRUE(is_counted(other));
  EXPECT_TRUE(is_counted(MappedVector<uint32_t>(other)));
  free_memory(other);
  EXPECT_FALSE(memory->holds(place));
}

TEST(MappedMemory, SmallArraysAndThoseWithoutRoomLieOnTheHeap) {
  const auto memory = memory_in(testing::TempDir());
  const MappedVector<uint32_t> small(1000, 5, MappedAllocator<uint32_t>(memory));
  EXPECT_FALSE(memory->holds(small.data()));
  EXPECT_TRUE(memory->trouble());
  EXPECT_EQ(memory->bytes_made(), 0u);

  const auto nowhere = memory_in("/no/such/folder");
  const MappedVector<uint32_t> v = counted(nowhere);
  EXPECT_FALSE(nowhere->holds(v.data()));
  ASSERT_FALSE(nowhere->trouble());
  EXPECT_NE(nowhere->trouble().error().message.find("/no/such/folder"), std::string::npos);
  EXPECT_TRUE(is_counted(v));
}

}  // namespace
}  // namespace luxel
