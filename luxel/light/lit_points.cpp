#include "luxel/light/lit_points.h"

#include <algorithm>

#include "luxel/base/random.h"

namespace luxel::light {
namespace {

/// Any number: it sets the random numbers of points apart from others of the same seed.
constexpr uint64_t kPointSeed = 0x70e1;

}  // namespace

int samples_per_point(int samples) { return std::max(std::min(samples, 8), samples / 8); }

void receive_at_points(const PointScene& place, uint64_t seed, size_t i, PointBuffers& work) {
  work.receivers.clear();
  for (const scene::SurfacePoint& p : work.spread) {
    const uint64_t own = hash64(hash64(seed, kPointSeed + work.receivers.size()), i);
    work.receivers.push_back(receiver_at(place, transport::smooth_point(place.scene, p), own));
  }
  work.light.resize(work.receivers.size());
}

void light_points(const PointScene& place, const Lights& lights, const DirectParams& each, size_t i,
                  PointBuffers& work) {
  receive_at_points(place, each.seed, i, work);
  direct_light_at({place.scene, lights, place.tracer, place.diagonal_m}, each, work.receivers,
                  work.batch, work.light);
}

}  // namespace luxel::light
