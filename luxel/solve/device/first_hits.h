// Gather's rays on a graphics device: made there, traced there, and what they meet kept there.
#pragma once

#include "luxel/solve/gather/rays/element_rays.h"
#include "luxel/trace/vulkan/device_ray_tracer.h"
#include "luxel/transport/elements.h"

namespace luxel::device {

/// What elements' rays meet, in a device's memory.
struct FirstHits {
  size_t elements = 0;
  uint32_t samples = 0;  ///< rays per element
  gpu::Buffer hits;      ///< trace::DeviceHit, at index_of()
  double seconds = 0;    ///< that the device took

  /// Of 64 elements after each other: the first ray of each, the second of each and so on. `place`:
  /// in the order of cells, as gather::element_rays() has an element's rays.
  size_t index_of(size_t element, size_t place) const {
    return (element / 64 * samples + place) * 64 + element % 64;
  }
};

struct FirstHitsParams {
  uint32_t samples = 64;
  uint64_t seed = 1;
};

/// Element i sends the rays that gather sends from it, with gather::seed_of_rays(seed, i): the same
/// up to rounding. `piece` is of groups of 64 rays or so; kFirstPiece where nothing is known.
/// Errors: no memory, the device is lost.
inline constexpr gpu::PieceSize kFirstPiece{64};
Result<FirstHits> first_hits(const trace::DeviceRayTracer& tracer, gpu::Commands& commands,
                             const transport::Elements& elements, float diagonal_m,
                             const FirstHitsParams& params, gpu::PieceSize& piece);

}  // namespace luxel::device
