#include "luxel/base/row_store.h"

#include <gtest/gtest.h>

#include "luxel/base/parallel.h"
#include "luxel/base/random.h"

namespace luxel {
namespace {

struct Entry {
  uint32_t column = 0, value = 0;
  friend bool operator==(const Entry&, const Entry&) = default;
};

constexpr size_t kTile = 8, kMostEntries = 50;

/// The rows of a tile: some empty, some full.
RowTile<Entry> tile_of(size_t tile, size_t rows) {
  RowTile<Entry> out;
  RandomStream random{tile};
  for (size_t r = 0; r < rows; ++r) {
    const size_t count = random.next() < 0.2f ? 0 : size_t(random.next() * (kMostEntries + 1));
    for (size_t k = 0; k < count; ++k)
      out.entries.push_back({uint32_t(k), uint32_t(1000 * tile + r)});
    out.end.push_back(uint32_t(out.entries.size()));
  }
  return out;
}

TEST(RowStore, GivesBackWhatItGotFromMemoryAndFile) {
  constexpr size_t kElements = 803;  // the last tile has three rows
  const uint64_t slot = kTile * kMostEntries * sizeof(Entry);
  uint64_t bytes = 0;
  const std::pair<uint64_t, TilesInMemory> kinds[] = {
      {UINT64_MAX, TilesInMemory::first_numbers}, {0, TilesInMemory::first_numbers},
      {10 * slot, TilesInMemory::first_numbers},  {10 * slot - 1, TilesInMemory::first_numbers},
      {UINT64_MAX, TilesInMemory::first_come},    {10 * slot, TilesInMemory::first_come}};
  for (const auto& [limit, in_memory] : kinds) {
    auto store = RowStore<Entry>::create(kElements, kTile, kMostEntries, limit,
                                         std::filesystem::temp_directory_path(), in_memory);
    ASSERT_TRUE(store) << store.error().message;
    ASSERT_EQ(store->tile_count(), 101u);
    const auto rows_of = [&](size_t t) { return t == 100 ? 3 : kTile; };
    parallel_for(101, 1, [&](size_t begin, size_t end) {
      for (size_t t = begin; t < end; ++t) EXPECT_TRUE(store->put(t, tile_of(t, rows_of(t))));
    });
    for (size_t t = 101; t-- > 0;) {
      RowTile<Entry> buffer;
      const auto tile = store->get(t, buffer);
      ASSERT_TRUE(tile);
      const RowTile<Entry> expected = tile_of(t, rows_of(t));
      EXPECT_EQ((*tile)->end, expected.end);
      EXPECT_EQ((*tile)->entries, expected.entries);
    }
    if (bytes == 0) bytes = store->bytes_in_memory();
    EXPECT_EQ(store->bytes_in_memory() + store->bytes_in_file(), bytes);
    EXPECT_LE(store->bytes_in_memory(), limit);
    EXPECT_EQ(store->bytes_in_file() == 0, limit == UINT64_MAX);
  }
}

// A process that has only tiles of large numbers still has them in memory.
TEST(RowStore, KeepsInMemoryWhatComesFirst) {
  const uint64_t slot = kTile * kMostEntries * sizeof(Entry);
  auto store =
      RowStore<Entry>::create(803, kTile, kMostEntries, 10 * slot,
                              std::filesystem::temp_directory_path(), TilesInMemory::first_come);
  ASSERT_TRUE(store);
  for (size_t t = 90; t < 100; ++t) ASSERT_TRUE(store->put(t, tile_of(t, kTile)));
  EXPECT_EQ(store->bytes_in_file(), 0u);
  ASSERT_TRUE(store->put(3, tile_of(3, kTile)));
  EXPECT_GT(store->bytes_in_file(), 0u);
}

TEST(RowStore, OfNothingNeedsNoFile) {
  const auto store = RowStore<Entry>::create(0, kTile, 0, 0, "/nonexistent");
  ASSERT_TRUE(store);
  EXPECT_EQ(store->tile_count(), 0u);
}

TEST(RowStore, AFolderThatIsNotThereIsAnError) {
  const auto store = RowStore<Entry>::create(100, kTile, kMostEntries, 0, "/nonexistent");
  ASSERT_FALSE(store);
  EXPECT_EQ(store.error().code, ErrorCode::io);
}

}  // namespace
}  // namespace luxel
