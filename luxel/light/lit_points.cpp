#include "luxel/light/lit_points.h"

#include <algorithm>
#include <atomic>

#include "luxel/base/parallel.h"
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
    work.receivers.push_back(receiver_at(transport::smooth_point(place.scene, p), own));
  }
}

void light_receivers(const DirectScene& lit, const LightAsked& asked, PointBuffers& work) {
  work.light.resize(work.receivers.size());
  if (asked.punctual_alone)
    punctual_light_at(lit, asked.samples, work.receivers, work.batch, work.light);
  else
    direct_light_at(lit, {.samples = asked.samples}, work.receivers, work.batch, work.light);
}

namespace {

/// Points of a texel between WorkOnPoints::begin() and end(), while the device lights them.
struct WaitingPoints {
  std::vector<Receiver> receivers;
  std::vector<uint8_t> on_side;
};

/// Receivers that wait for the device at a time, 40 MB with their light.
constexpr size_t kWaitingAtATime = size_t(1) << 19;

/// Texels [first, first + count) by the device. Returns the number of rays.
Result<uint64_t> light_some_on_device(LightDevice& device, size_t first, size_t count,
                                      const LightAsked& asked, const WorkOnPoints& texels,
                                      Progress& progress) {
  std::atomic<uint64_t> rays{0};
  std::vector<WaitingPoints> waiting(count);
  parallel_for(count, kSupersampleGrain, [&](size_t begin, size_t end) {
    if (progress.cancelled()) return;
    PointBuffers work;
    for (size_t k = begin; k < end; ++k) {
      work.receivers.clear(), work.on_side.clear();
      rays += texels.begin(first + k, work);
      waiting[k] = {work.receivers, work.on_side};
    }
  });
  LUXEL_TRY_STATUS(stopped(progress));
  std::vector<Receiver> receivers;
  std::vector<size_t> first_of;
  for (const WaitingPoints& points : waiting) {
    first_of.push_back(receivers.size());
    receivers.insert(receivers.end(), points.receivers.begin(), points.receivers.end());
  }
  std::vector<LightAt> light(receivers.size());
  LUXEL_TRY(const uint64_t shadow_rays, device.light_at(receivers, asked, light, progress));
  parallel_for(count, kSupersampleGrain, [&](size_t begin, size_t end) {
    PointBuffers work;
    for (size_t k = begin; k < end; ++k) {
      if (waiting[k].receivers.empty()) continue;
      work.receivers = std::move(waiting[k].receivers);
      work.on_side = std::move(waiting[k].on_side);
      const auto from = light.begin() + std::ptrdiff_t(first_of[k]);
      work.light.assign(from, from + std::ptrdiff_t(work.receivers.size()));
      rays += texels.end(first + k, work);
    }
  });
  return rays + shadow_rays;
}

}  // namespace

Result<uint64_t> light_many_points(const TexelScene& in, size_t count, size_t most_points,
                                   const LightAsked& asked, const WorkOnPoints& texels,
                                   Progress& progress) {
  if (in.light_device) {
    const size_t at_a_time = std::max<size_t>(kWaitingAtATime / most_points, 1);
    uint64_t rays = 0;
    for (size_t first = 0; first < count; first += at_a_time) {
      const size_t some = std::min(at_a_time, count - first);
      LUXEL_TRY(const uint64_t more,
                light_some_on_device(*in.light_device, first, some, asked, texels, progress));
      rays += more;
      if (texels.advances) progress.advance(some);
    }
    return rays;
  }
  const DirectScene lit{in.scene, in.lights, in.tracer};
  std::atomic<uint64_t> rays{0};
  parallel_for(count, kSupersampleGrain, [&](size_t begin, size_t end) {
    if (progress.cancelled()) return;
    PointBuffers work;
    uint64_t traced = 0;
    for (size_t k = begin; k < end; ++k) {
      work.receivers.clear(), work.on_side.clear();
      traced += texels.begin(k, work);
      if (work.receivers.empty()) continue;
      light_receivers(lit, asked, work);
      traced += work.batch.rays.size() + texels.end(k, work);
    }
    rays += traced;
    if (texels.advances) progress.advance(end - begin);
  });
  LUXEL_TRY_STATUS(stopped(progress));
  return uint64_t(rays);
}

}  // namespace luxel::light
