// Direct light at the points of a texel.
#pragma once

#include <cstdint>
#include <vector>

#include "luxel/light/direct_light.h"
#include "luxel/light/points_of_texels.h"
#include "luxel/light/shadow_rays.h"

namespace luxel::light {

/// Texels of a part of the work: each needs hundreds of rays, and a part is what a checkpoint
/// keeps.
inline constexpr size_t kSupersampleGrain = 16;

/// Shadow rays of a point, where a texel's sample has `samples`.
int samples_per_point(int samples);

/// Buffers of one thread.
struct PointBuffers {
  std::vector<scene::SurfacePoint> spread;
  std::vector<uint8_t> on_side;  ///< per point of spread
  std::vector<Receiver> receivers;
  std::vector<LightAt> light;
  ShadowRayBatch batch;
};

/// Makes work.receivers of work.spread, the points of texel `i`, and room for their light.
void receive_at_points(const PointScene& place, uint64_t seed, size_t i, PointBuffers& work);

/// The direct light at work.spread, the points of texel `i`.
void light_points(const PointScene& place, const Lights& lights, const DirectParams& each, size_t i,
                  PointBuffers& work);

}  // namespace luxel::light
