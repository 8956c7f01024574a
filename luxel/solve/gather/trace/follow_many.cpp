#include "luxel/solve/gather/trace/follow_many.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "luxel/base/check.h"
#include "luxel/base/parallel.h"
#include "luxel/solve/gather/trace/follow_on.h"

namespace luxel::gather {
namespace {

constexpr size_t kGrain = 512;
/// Paths that are followed at a time: 80 MB with their rays and light.
constexpr size_t kManyPaths = size_t(1) << 18;

/// Some paths on their way.
struct Many {
  const RayScene& in;
  const PathDevice& device;
  TracedHits& hits;
  FollowedPaths& out;
  std::vector<NearPath> paths;
  std::vector<light::Receiver> receivers{};
  std::vector<light::LightAt> light{};
  std::vector<trace::Ray> rays{};
  std::vector<trace::Hit> met{};
  std::vector<uint8_t> goes{};  ///< per path, whether it goes on

  /// Calls visit(k) for each path, on several threads.
  template <class Visit>
  void for_each(const Visit& visit) {
    parallel_for(paths.size(), kGrain, [&](size_t begin, size_t end) {
      for (size_t k = begin; k < end; ++k) visit(k);
    });
  }
  void end_others();
  Status step(uint64_t depth, Progress& progress);
};

/// Paths that do not go on have ended, and leave room.
void Many::end_others() {
  const size_t before = out.paths.size();
  std::vector<size_t> place(paths.size());
  for (size_t k = 0, next = before; k < paths.size(); ++k) place[k] = goes[k] ? next : next++;
  out.paths.resize(before + size_t(std::ranges::count(goes, 0)));
  for_each([&](size_t k) {
    if (!goes[k]) out.paths[place[k]] = ended(in, paths[k], hits);
  });
  size_t alive = 0;
  for (size_t k = 0; k < paths.size(); ++k) {
    if (!goes[k]) continue;
    if (k < receivers.size()) receivers[alive] = receivers[k];
    paths[alive++] = paths[k];
  }
  paths.resize(alive), receivers.resize(std::min(receivers.size(), alive));
}

/// step_near(), and which paths go on from where that has led.
Status Many::step(uint64_t depth, Progress& progress) {
  const NearScene& near = *in.near;
  receivers.clear();
  // 1. Paths on black surfaces end.
  goes.assign(paths.size(), 0);
  for_each([&](size_t k) { goes[k] = reflect(near, paths[k]); });
  end_others();
  // 2. Light straight from the lights.
  receivers.resize(paths.size()), light.resize(paths.size());
  for_each([&](size_t k) { receivers[k] = receiver_of(near, depth, paths[k]); });
  LUXEL_TRY(const uint64_t shadow_rays,
            device.light.light_at(receivers, {.samples = 1}, light, progress));
  // 3. Each path goes on with one ray, or ends by chance.
  goes.assign(paths.size(), 0);
  for_each([&](size_t k) {
    NearPath& path = paths[k];
    path.light += path.throughput * light[k].irradiance / kPi;
    goes[k] = go_on(receivers[k], depth, path);
    if (!goes[k]) path.throughput = {};
  });
  end_others();
  rays.resize(paths.size()), met.resize(paths.size());
  for_each([&](size_t k) { rays[k] = {receivers[k].position, 0, paths[k].direction, INFINITY}; });
  LUXEL_TRY_STATUS(device.closest_hits(rays, met));
  out.rays += shadow_rays + rays.size();
  // 4. Most end where the map has an answer.
  goes.assign(paths.size(), 0);
  for_each([&](size_t k) {
    paths[k].hit = met[k];
    goes[k] = goes_on(near, paths[k]);
  });
  end_others();
  for (NearPath& path : paths) path.is_plain = false;
  return stopped(progress);
}

}  // namespace

Result<FollowedPaths> follow_many(const RayScene& in, const PathDevice& device,
                                  std::vector<NearPath> paths, TracedHits& hits,
                                  Progress& progress) {
  LUXEL_CHECK(in.near && !in.near->layers && !in.near->tracer.has_tints());
  FollowedPaths out;
  for (size_t first = 0; first < paths.size(); first += kManyPaths) {
    const auto from = paths.begin() + std::ptrdiff_t(first);
    const size_t count = std::min(kManyPaths, paths.size() - first);
    Many many{in, device, hits, out, {from, from + std::ptrdiff_t(count)}};
    for (uint64_t depth = 0; !many.paths.empty(); ++depth)
      LUXEL_TRY_STATUS(many.step(depth, progress));
  }
  std::ranges::sort(out.paths, {},
                    [](const FollowedPath& p) { return std::tuple(p.element, p.ray); });
  return out;
}

}  // namespace luxel::gather
