// Direct light at the points of a texel.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "luxel/light/direct_light.h"
#include "luxel/light/light_device.h"
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

/// Makes work.receivers of work.spread, the points of texel `i`.
void receive_at_points(const PointScene& place, uint64_t seed, size_t i, PointBuffers& work);

/// Makes work.light of work.receivers; work.batch has their shadow rays.
void light_receivers(const DirectScene& lit, const LightAsked& asked, PointBuffers& work);

/// Work on the points of some texels, by number. Both are called by many threads, and return how
/// many rays they have traced.
struct WorkOnPoints {
  /// Makes work.receivers, and maybe work.on_side; no receivers: the texel is left out.
  std::function<uint64_t(size_t k, PointBuffers& work)> begin;
  /// Gets what begin() has made, and work.light of the receivers.
  std::function<uint64_t(size_t k, PointBuffers& work)> end;
  bool advances = true;  ///< progress advances by a texel after each
};

/// Lights the points of `count` texels, on in.light_device if there is one. `most_points`: of a
/// texel. Returns how many rays were traced. Errors: cancelled; those of the device.
Result<uint64_t> light_many_points(const TexelScene& in, size_t count, size_t most_points,
                                   const LightAsked& asked, const WorkOnPoints& texels,
                                   Progress& progress);

}  // namespace luxel::light
