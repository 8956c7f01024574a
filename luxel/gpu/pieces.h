// Long work given to a device in pieces.
#pragma once

#include <functional>

#include "luxel/gpu/commands.h"

namespace luxel::gpu {

/// Items of the next piece. The first has few, in case that the device is slow. Each next one has
/// as many as take about 20 ms by what the last took, and at most four times as many as that:
/// drivers reset a device that works on one thing for seconds, and a screen waits for what is under
/// way.
struct PieceSize {
  size_t items = 4096;
};

using RecordPiece = std::function<void(VkCommandBuffer, size_t first, size_t count)>;
/// Calls record(commands, first, count) for pieces of [0, count), one after the other, each of
/// `most` items at most. Returns the seconds until the device was done, as the processor sees them.
/// What reads the results needs a full_barrier() first. Errors: the device is lost.
Result<double> run_in_pieces(Commands& commands, size_t count, size_t most, PieceSize& size,
                             const RecordPiece& record);

}  // namespace luxel::gpu
