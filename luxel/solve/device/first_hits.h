// Gather's rays on a graphics device: made there, traced there, and what they meet kept there.
#pragma once

#include "luxel/solve/device/device_elements.h"
#include "luxel/trace/vulkan/device_ray_tracer.h"

namespace luxel::device {

struct FirstHitsParams {
  uint32_t samples = 64;  ///< rays per element
  uint64_t seed = 1;
};

/// Rays of elements and what they meet, in a device's memory.
struct FirstHits {
  size_t element_count = 0;
  FirstHitsParams params;
  gpu::Buffer elements;
  gpu::Buffer hits;  ///< on_device::Hit, at index_of(); filled by trace_first_hits()
  gpu::Pipeline pipeline;
  gpu::PieceSize piece{64};  ///< of groups: each has the rays of 64 elements in one cell

  /// 64 elements lie after each other: the first ray of each, the second of each and so on.
  /// `place`: in the order of cells, as gather::element_rays() has an element's rays.
  size_t index_of(size_t element, size_t place) const {
    return (element / 64 * params.samples + place) * 64 + element % 64;
  }
};

/// Sends elements to the device and makes room for what their rays will meet. Some elements, and
/// fewer than 2^31 rays in all. Errors: no memory, the device is lost.
Result<FirstHits> prepare_first_hits(const trace::DeviceRayTracer& tracer, gpu::Commands& commands,
                                     const transport::Elements& elements,
                                     const FirstHitsParams& params);

/// Makes the rays and traces them: element i sends the rays that gather sends from it, with
/// gather::seed_of_rays(seed, i), the same up to rounding. Returns the seconds until the
/// device was done, as the processor sees them. Errors: the device is lost.
Result<double> trace_first_hits(const trace::DeviceRayTracer& tracer, gpu::Commands& commands,
                                FirstHits& hits);

}  // namespace luxel::device
