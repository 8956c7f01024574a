#include "luxel/solve/gather/trace/open_rays.h"

#include <algorithm>
#include <atomic>

#include "luxel/base/buffer_pool.h"
#include "luxel/base/check.h"
#include "luxel/base/free_memory.h"
#include "luxel/base/parallel.h"
#include "luxel/solve/gather/trace/follow_many.h"
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

/// Sorts the rays of the tile of elements [begin, end). Calls `full` whenever many paths wait to be
/// followed on.
template <class Full>
void sort_tile(const TraceScene& in, const RayScene& scene, std::span<const OpenRay> rays,
               size_t begin, size_t end, RayBuffers& buffers, TracedHits& hits, RayTile& tile,
               const Full& full) {
  buffers.near.paths.clear(), buffers.followed.clear(), buffers.ends_of.clear();
  for (size_t i = begin; i < end; ++i) {
    const std::span<const OpenRay> own = rays_of(rays, i, i + 1);
    take_rays(own, is_guided(hits, i), buffers);
    if (!own.empty()) {
      sort_rays(scene, buffers, i, {0, hits.samples[i]}, hits, tile);
      drop_enclosed_paths(scene, in.elements, i, hits, buffers.near);
    }
    tile.hits.end.push_back(uint32_t(tile.hits.entries.size()));
    buffers.ends_of.push_back(uint32_t(tile.ends.size()));
    if (buffers.near.paths.size() >= kPathsAtATime) full();
  }
}

/// Elements in tiles of kTileElements.
struct Tiles {
  size_t begin, end;

  size_t count() const { return (end - begin + kTileElements - 1) / kTileElements; }
  size_t first(size_t tile) const { return begin + tile * kTileElements; }
  size_t last(size_t tile) const { return std::min(first(tile) + kTileElements, end); }
};

/// A tile whose paths are on their way.
struct WaitingTile {
  RayTile tile;
  std::vector<uint32_t> ends_of;  ///< RayBuffers::ends_of
  std::vector<NearPath> paths;
};

/// Paths of all tiles, tile after tile.
std::vector<NearPath> take_paths(std::span<WaitingTile> tiles) {
  std::vector<NearPath> out;
  for (WaitingTile& tile : tiles) {
    out.insert(out.end(), tile.paths.begin(), tile.paths.end());
    free_memory(tile.paths);
  }
  return out;
}

/// end_open_rays() with a device for paths.
Result<std::vector<HitTile>> end_on_device(const SceneOfRays& scene, const TraceScene& in,
                                           const Tiles& tiles, std::span<const OpenRay> rays,
                                           const PathDevice& device, TracedHits& hits,
                                           Progress& progress) {
  std::vector<WaitingTile> waiting(tiles.count());
  BufferPool<RayBuffers> pool;
  parallel_for(waiting.size(), 1, [&](size_t t, size_t) {
    if (progress.cancelled()) return;
    RayBuffers buffers = pool.take();
    const size_t first = tiles.first(t), last = tiles.last(t);
    sort_tile(in, scene.rays(), rays_of(rays, first, last), first, last, buffers, hits,
              waiting[t].tile, [] {});
    waiting[t].ends_of = buffers.ends_of, waiting[t].paths = buffers.near.paths;
    pool.give(std::move(buffers));
  });
  LUXEL_TRY_STATUS(stopped(progress));
  FollowedPaths followed;
  if (std::vector<NearPath> paths = take_paths(waiting); !paths.empty()) {
    LUXEL_TRY(followed, follow_many(scene.rays(), device, std::move(paths), hits, progress));
  }
  hits.rays += followed.rays;
  std::vector<HitTile> out(waiting.size());
  parallel_for(out.size(), 1, [&](size_t t, size_t) {
    RayBuffers buffers = pool.take();
    const auto own = [&](size_t element) {
      return std::ranges::lower_bound(followed.paths, element, {}, &FollowedPath::element);
    };
    buffers.near.paths.clear();
    buffers.followed.assign(own(tiles.first(t)), own(tiles.last(t)));
    follow_on(scene.rays(), tiles.first(t), waiting[t].ends_of, nullptr, buffers, hits,
              waiting[t].tile);
    out[t] = std::move(waiting[t].tile.hits);
    pool.give(std::move(buffers));
  });
  return out;
}

}  // namespace

Result<std::vector<HitTile>> end_open_rays(const SceneOfRays& scene, const TraceScene& in,
                                           size_t begin, size_t end, std::span<const OpenRay> rays,
                                           const PathDevice* device, TracedHits& hits,
                                           Progress& progress) {
  LUXEL_CHECK(begin % kTileElements == 0 && begin <= end && end <= hits.size());
  const Tiles tiles{begin, end};
  if (device && scene.rays().near)
    return end_on_device(scene, in, tiles, rays, *device, hits, progress);
  std::vector<HitTile> out(tiles.count());
  std::atomic<uint64_t> more{0};
  BufferPool<RayBuffers> pool;
  parallel_for(out.size(), 1, [&](size_t t, size_t) {
    if (progress.cancelled()) return;
    const size_t first = tiles.first(t), last = tiles.last(t);
    RayBuffers buffers = pool.take();
    RayTile tile;
    sort_tile(in, scene.rays(), rays_of(rays, first, last), first, last, buffers, hits, tile,
              [&] { more += follow_paths(scene.rays(), buffers, hits); });
    more += follow_on(scene.rays(), first, buffers.ends_of, nullptr, buffers, hits, tile);
    out[t] = std::move(tile.hits);
    pool.give(std::move(buffers));
  });
  hits.rays += more;
  LUXEL_TRY_STATUS(stopped(progress));
  return out;
}

}  // namespace luxel::gather
