// A chunk's rays as parts that are kept, with which the processor goes on.
#pragma once

#include "luxel/gpu/commands.h"
#include "luxel/solve/device/ray_slots.h"
#include "luxel/solve/gather/trace/kept_hits.h"

namespace luxel::device {

/// A chunk whose rays have ended.
struct EndedChunk {
  const SlotChunk& slots;
  std::span<const uint32_t> rays;          ///< per slot
  uint64_t followed;                       ///< rays that paths took
  std::span<const gather::HitTile> ended;  ///< hits of rays that the processor has ended
};

/// Where parts are kept, and what they are made of.
struct ChunkKeeper {
  const KeptStage& kept;
  gpu::Commands& commands;
  const gather::TracedHits& hits;  ///< with what it counts of the chunk's elements
};

/// Keeps a chunk's tiles as parts, if that is wanted, as gather keeps those that it traces. Each
/// gets a share of the rays that paths took. `landed`: LandedChunk::hits. Errors: no memory, the
/// device is lost.
Status keep_chunk(const EndedChunk& chunk, const gpu::Buffer& landed, const ChunkKeeper& keeper);

}  // namespace luxel::device
