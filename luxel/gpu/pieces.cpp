#include "luxel/gpu/pieces.h"

#include <algorithm>

#include "luxel/base/check.h"
#include "luxel/base/clock.h"

namespace luxel::gpu {
namespace {

constexpr double kPieceSeconds = 0.02, kMostGrowth = 4;

}  // namespace

Result<double> run_in_pieces(Commands& commands, size_t count, size_t most, PieceSize& size,
                             const RecordPiece& record, const Progress* asked) {
  LUXEL_CHECK(most > 0);
  double seconds = 0;
  for (size_t first = 0; first < count;) {
    if (asked) LUXEL_TRY_STATUS(stopped(*asked));
    const size_t some = std::min({std::max<size_t>(size.items, 1), most, count - first});
    const auto start = Clock::now();
    LUXEL_TRY_STATUS(commands.run([&](VkCommandBuffer c) {
      full_barrier(commands.device(), c);
      record(c, first, some);
    }));
    const double took = std::max(seconds_since(start), 1e-9);
    seconds += took, first += some;
    // A piece that was cut short changes the size only where it took long.
    const auto next = size_t(double(some) * std::min(kMostGrowth, kPieceSeconds / took));
    size.items = some < size.items && took < kPieceSeconds ? size.items : next;
  }
  return seconds;
}

}  // namespace luxel::gpu
