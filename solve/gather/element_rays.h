// The rays that an element sends out, in the order in which they are traced.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "trace/ray_tracer.h"

namespace luxel::gather {

/// Which samples of an element.
struct Samples {
  uint32_t first = 0, end = 0;

  uint32_t count() const { return end - first; }
  /// Whether a sample belongs to the second half of all up to `end`.
  bool in_second_half(uint32_t sample) const { return 2 * sample >= end; }
};

/// Rays of one element with the number of the sample that each belongs to; and buffers, reused from
/// element to element.
struct RayBatch {
  std::vector<trace::Ray> rays;
  std::vector<uint32_t> sample;
  std::vector<float> u, v, x, y, z;
  std::vector<uint8_t> cell;

  void resize(size_t samples);
};

/// Cosine-distributed about `normal`, those below the triangle mirrored to above it; sorted so that
/// neighbours in a packet point in similar directions. A sample's ray is the same in any batch.
void fill_rays(Vec3 origin, Vec3 normal, Vec3 geometric_normal, uint64_t seed, Samples samples,
               RayBatch& batch);

/// The same for the first rays.size() samples. Shared with `luxel bench rays`.
void element_rays(Vec3 origin, Vec3 normal, Vec3 geometric_normal, uint64_t seed,
                  std::span<trace::Ray> rays);

}  // namespace luxel::gather
