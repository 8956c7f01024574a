#include "luxel/solve/gather/trace/open_rays.h"

#include <algorithm>
#include <atomic>

#include "luxel/base/buffer_pool.h"
#include "luxel/base/check.h"
#include "luxel/base/parallel.h"
#include "luxel/solve/gather/trace/follow_on.h"
#include "luxel/solve/gather/trace/scene_of_rays.h"

namespace luxel::gather {
namespace {

/// The rays of elements [begin, end).
std::span<const OpenRay> rays_of(std::span<const OpenRay> rays, size_t begin, size_t end) {
  const auto first = std::ranges::lower_bound(rays, begin, {}, &OpenRay::element);
  const auto last = std::ranges::lower_bound(rays, end, {}, &OpenRay::element);
  return {first, last};
}

/// Puts an element's rays into the buffers as if they had been traced there. They need no
/// directions: none of them has left the scene.
void take_rays(std::span<const OpenRay> rays, bool guided, RayBuffers& buffers) {
  RayBatch& batch = buffers.batch;
  batch.rays.resize(rays.size()), batch.sample.clear(), batch.doublings.clear();
  buffers.hits.clear(), buffers.tint.clear();
  for (const OpenRay& ray : rays)
    batch.sample.push_back(ray.sample), buffers.hits.push_back(ray.hit);
  if (guided)
    for (const OpenRay& ray : rays) batch.doublings.push_back(uint8_t(ray.doublings));
}

/// Ends the rays of the tile of elements [begin, end). Returns how many more were traced.
uint64_t end_tile(const TraceScene& in, const RayScene& scene, std::span<const OpenRay> rays,
                  size_t begin, size_t end, RayBuffers& buffers, TracedHits& hits, RayTile& tile) {
  buffers.near.paths.clear(), buffers.followed.clear(), buffers.ends_of.clear();
  uint64_t more = 0;
  for (size_t i = begin; i < end; ++i) {
    const std::span<const OpenRay> own = rays_of(rays, i, i + 1);
    take_rays(own, is_guided(hits, i), buffers);
    if (!own.empty()) {
      sort_rays(scene, buffers, i, {0, hits.samples[i]}, hits, tile);
      drop_enclosed_paths(scene, in.elements, i, hits, buffers.near);
    }
    tile.hits.end.push_back(uint32_t(tile.hits.entries.size()));
    buffers.ends_of.push_back(uint32_t(tile.ends.size()));
    if (buffers.near.paths.size() >= kPathsAtATime) more += follow_paths(scene, buffers, hits);
  }
  return more + follow_on(scene, begin, buffers.ends_of, nullptr, buffers, hits, tile);
}

}  // namespace

Result<std::vector<HitTile>> end_open_rays(const SceneOfRays& scene, const TraceScene& in,
                                           size_t begin, size_t end, std::span<const OpenRay> rays,
                                           TracedHits& hits, Progress& progress) {
  LUXEL_CHECK(begin % kTileElements == 0 && begin <= end && end <= hits.size());
  std::vector<HitTile> out((end - begin + kTileElements - 1) / kTileElements);
  std::atomic<uint64_t> more{0};
  BufferPool<RayBuffers> pool;
  parallel_for(out.size(), 1, [&](size_t t, size_t) {
    if (progress.cancelled()) return;
    const size_t first = begin + t * kTileElements, last = std::min(first + kTileElements, end);
    RayBuffers buffers = pool.take();
    RayTile tile;
    more +=
        end_tile(in, scene.rays(), rays_of(rays, first, last), first, last, buffers, hits, tile);
    out[t] = std::move(tile.hits);
    pool.give(std::move(buffers));
  });
  hits.rays += more;
  LUXEL_TRY_STATUS(stopped(progress));
  return out;
}

}  // namespace luxel::gather
