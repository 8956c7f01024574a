// Long work given to a device in pieces.
#pragma once

#include <functional>

#include "luxel/base/progress.h"
#include "luxel/gpu/commands.h"
#include "luxel/gpu/pipeline.h"

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
/// Each piece begins with a full_barrier(), and reading the results needs one first, too. `asked`:
/// may ask to stop between pieces; null: nobody does. Errors: the device is lost, cancelled.
Result<double> run_in_pieces(Commands& commands, size_t count, size_t most, PieceSize& size,
                             const RecordPiece& record, const Progress* asked = nullptr);

/// run_in_pieces() for `count` work groups of a compute pipeline: each piece is told its first one
/// by Push::first_group.
template <class Push>
Result<double> run_groups(Commands& commands, const Pipeline& pipeline, Push push, size_t count,
                          PieceSize& size, const Progress* asked = nullptr) {
  const Device& device = commands.device();
  return run_in_pieces(
      commands, count, device.limits.maxComputeWorkGroupCount[0], size,
      [&](VkCommandBuffer c, size_t first, size_t groups) {
        push.first_group = uint32_t(first);
        bind(device, c, pipeline, push);
        device.vk.vkCmdDispatch(c, uint32_t(groups), 1, 1);
      },
      asked);
}

}  // namespace luxel::gpu
