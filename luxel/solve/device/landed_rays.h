// Gather's rays on a graphics device. It makes them, traces them, and keeps where they land. The
// processor finds what only it knows. [Moreno05, ch. 4]
#pragma once

#include "luxel/base/progress.h"
#include "luxel/gpu/pieces.h"
#include "luxel/solve/device/device_surroundings.h"
#include "luxel/solve/gather/trace/trace_hits.h"
#include "luxel/trace/vulkan/device_ray_tracer.h"

namespace luxel::device {

/// Where some elements' rays of a round have landed, in a device's memory.
struct LandedChunk {
  size_t slot_count = 0, tile_count = 0;
  gpu::Buffer slots;      ///< RaySlot
  gpu::Buffer first_row;  ///< SlotChunk::first_row
  gpu::Buffer hits;       ///< gather::StoredHit, row by row
};

struct LandedRound {
  std::vector<LandedChunk> chunks;
  gpu::Buffer more;  ///< gather::StoredHit of rays that the processor ended, element after element
  gpu::Buffer ends;  ///< uint32_t per element: one past its last one of `more`
};

/// Where the rays of all elements have landed, round by round, and what all rounds need.
struct LandedRays {
  size_t element_count = 0;
  gpu::Buffer elements;
  gpu::Buffer landings;  ///< Landing of each side of each triangle
  gpu::Buffer mixed;     ///< transport::OwnSides::mixed
  bool is_dark_around = true;
  DeviceSurroundings around;  ///< where light comes from around
  gpu::Pipeline land, escaped;
  gpu::PieceSize land_piece{64}, escaped_piece{64};
  uint32_t places_of_piece = 0;  ///< of a slot, for which the sizes of pieces are

  std::vector<LandedRound> rounds;
  /// Per element, the first round that counts, and in the second byte the last one that added rays.
  gpu::Buffer counted_rounds;
  uint64_t left_open = 0;  ///< rays that the processor has ended

  // Sweeps need these, from the first one on.
  gpu::Pipeline sweep;
  gpu::PieceSize sweep_piece{64};  ///< of tiles
  gpu::Buffer map_sent, map;       ///< the texels of a gather::RadiosityMap
  gpu::Buffer gathered, to_host;   ///< on_device::Gathered of each element
};

struct LandParams {
  /// Hits of so many rays lie in one buffer, 256 MB, or those of gather::kTileElements elements.
  uint64_t rays_of_chunk = uint64_t(1) << 25;
  /// Room for open rays at first: one of so many of a chunk's. Where more are left open, as in a
  /// city whose every wall is thin, it runs again.
  uint64_t open_share = 3;
};

/// The time of each step of a round [s].
struct LandedSeconds {
  double device = 0;     ///< until the device was done with rays and sky
  double processor = 0;  ///< to end what the device has left open
};

/// Where rays are traced on the device; `in` is what the processor needs to end some of them.
struct DeviceScene {
  trace::DeviceRayTracer& tracer;
  gpu::Commands& commands;
  const gather::TraceScene& in;
  light::LightDevice* light = nullptr;  ///< lights where paths go on; null: the processor
};

/// Makes a scene ready for rounds of rays. Some elements; scenes without tints. Errors: no memory,
/// the device is lost.
Result<LandedRays> begin_rays(const DeviceScene& scene, const gather::TraceParams& params);

/// A round of samples, as gather::trace_more() traces it: the same rays up to rounding, and what
/// they meet by the same rules. `hits` gets what that counts and the light that rays bring without
/// the map; its rounds stay as they are, as many as those of `rays` were. The processor ends the
/// rays of one buffer before the device begins the next one. Its tiles are kept as parts then.
/// `scene` and `params` are about what `rays` began with; in params neither keep, earlier nor
/// layers. Errors: 2^31 rays or more that the processor must end (ErrorCode::unsupported),
/// cancelled, no memory, the device is lost.
Status land_round(const DeviceScene& scene, std::span<const uint16_t> target,
                  const LandParams& land, const gather::TraceParams& params, LandedRays& rays,
                  gather::TracedHits& hits, LandedSeconds& seconds, Progress& progress);

}  // namespace luxel::device
