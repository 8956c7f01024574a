// Gather's first round of rays on a graphics device: made there, traced there, and where they land
// kept there. What only the processor knows, it finds. [Moreno05, ch. 4]
#pragma once

#include "luxel/base/progress.h"
#include "luxel/solve/gather/trace/trace_hits.h"
#include "luxel/trace/vulkan/device_ray_tracer.h"

namespace luxel::device {

/// Places of some elements' rays, in a device's memory.
struct LandedChunk {
  size_t first_tile = 0, tile_count = 0;  ///< of 64 elements
  gpu::Buffer hits;                       ///< gather::StoredHit, at index_of()
};

/// Where the rays of all elements have landed.
struct LandedRays {
  size_t element_count = 0;
  uint32_t samples = 0;
  uint64_t left_open = 0;  ///< rays that the processor has ended
  std::vector<LandedChunk> chunks;
  gpu::Buffer more;  ///< gather::StoredHit of rays that the processor ended, element after element
  gpu::Buffer ends;  ///< uint32_t per element: one past its last one of `more`
  // What sweeps need, from the first one on.
  gpu::Pipeline sweep;
  gpu::PieceSize sweep_piece{64};  ///< of groups of 64 elements
  gpu::Buffer map_sent, map;       ///< the texels of a gather::RadiosityMap
  gpu::Buffer gathered, to_host;   ///< DeviceGathered of each element

  /// The place of a ray in its chunk, which begins with element 64 * first_tile: 64 elements lie
  /// after each other, the first ray of each, the second of each and so on.
  size_t index_of(size_t element_of_chunk, size_t place) const {
    return (element_of_chunk / 64 * samples + place) * 64 + element_of_chunk % 64;
  }
};

struct LandParams {
  int samples = 64;  ///< per element
  /// Hits of so many rays lie in one buffer, 256 MB, or those of gather::kTileElements elements.
  uint64_t rays_of_chunk = uint64_t(1) << 25;
  /// Room for open rays at first: one of so many of a chunk's. Where more are left open, as in a
  /// city whose every wall is thin, it runs again.
  uint64_t open_share = 3;
};

/// How long the steps of a round took [s].
struct LandedSeconds {
  double device = 0;     ///< until the device was done with rays and sky
  double processor = 0;  ///< to end what the device has left open
};

/// Where rays are traced on the device; `in` is what the processor needs to end some of them.
struct DeviceScene {
  const trace::DeviceRayTracer& tracer;
  gpu::Commands& commands;
  const gather::TraceScene& in;
};

/// The samples of all elements, as gather::trace_hits() traces them: the same rays up to rounding,
/// and what they meet by the same rules. `hits` gets what that counts and the light that rays bring
/// without the map; its rounds stay empty. The processor ends the rays of one buffer before the
/// device begins the next one. Some elements. In params neither parts, keep, earlier nor layers;
/// scenes without tints. Errors: 2^31 rays or more that the processor must end
/// (ErrorCode::unsupported), cancelled, no memory, the device is lost.
Result<LandedRays> land_rays(const DeviceScene& scene, const LandParams& land,
                             const gather::TraceParams& params, gather::TracedHits& hits,
                             LandedSeconds& seconds, Progress& progress);

}  // namespace luxel::device
