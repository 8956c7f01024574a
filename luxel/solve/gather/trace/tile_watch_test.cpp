// Tiles are handed out once each, those that are preferred first.
#include "luxel/solve/gather/trace/tile_watch.h"

#include <gmock/gmock.h>

namespace luxel::gather {
namespace {

using ::testing::ElementsAre;

std::vector<size_t> next_tiles(TileQueue& queue, size_t count) {
  std::vector<size_t> out;
  for (size_t i = 0; i < count; ++i) out.push_back(queue.next());
  return out;
}

TEST(TileQueue, HandsOutWhatIsPreferredFirst) {
  TileQueue queue(6);
  EXPECT_THAT(next_tiles(queue, 1), ElementsAre(0));
  queue.prefer([](size_t tile) { return tile == 4 ? 1.0f : tile == 2 ? 0.5f : 0.0f; });
  EXPECT_THAT(next_tiles(queue, 3), ElementsAre(4, 2, 1));
  queue.prefer([](size_t tile) { return float(tile); });
  EXPECT_THAT(next_tiles(queue, 2), ElementsAre(5, 3));
}

}  // namespace
}  // namespace luxel::gather
