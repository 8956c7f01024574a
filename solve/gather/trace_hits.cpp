#include "solve/gather/trace_hits.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <mutex>
#include <optional>

#include "base/buffer_pool.h"
#include "base/check.h"
#include "base/parallel.h"
#include "base/random.h"
#include "scene/sides.h"
#include "solve/gather/element_rays.h"
#include "solve/gather/kept_hits.h"
#include "solve/gather/sort_rays.h"
#include "transport/backs_seen.h"

namespace luxel::gather {

std::vector<StoredHit> places_behind(const scene::Scene& scene, const atlas::Atlas& atlas,
                                     const atlas::TexelMap& map,
                                     const transport::Elements& elements) {
  std::vector<StoredHit> out(elements.transmittance.size());
  parallel_for(out.size(), 4096, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const scene::SurfacePoint& p = map.texels[i].sample;
      out[i] = store(atlas, scene::other_side_of(scene, p).value_or(p), {});
    }
  });
  return out;
}

uint64_t TracedHits::bytes_in_memory() const {
  uint64_t bytes = 0;
  for (const HitStore& round : rounds) bytes += round.bytes_in_memory();
  return bytes;
}

uint64_t TracedHits::bytes_in_file() const {
  uint64_t bytes = 0;
  for (const HitStore& round : rounds) bytes += round.bytes_in_file();
  return bytes;
}

TracedHits no_hits(size_t elements, size_t layers) {
  TracedHits out;
  out.samples.resize(elements), out.last_round.resize(elements);
  out.escaped.resize(elements), out.met_back.resize(elements);
  out.met_double_sided_back.resize(elements);
  out.sky.resize(elements), out.sky_by_layer.resize(elements * layers);
  out.sky_luminance2.resize(elements), out.sky_first_less_second.resize(elements);
  return out;
}

namespace {

/// StoredHit::base() of the last texel that has another below and to the right, plus one.
uint32_t places_of(const atlas::Atlas& atlas) {
  const uint32_t side = uint32_t(atlas.resolution);
  return (side + 2) * (side + 1) - 1;
}

/// One round's way through the elements.
struct Round {
  const RayWorld& world;
  const transport::Elements& elements;
  const trace::RayTracer& tracer;
  std::span<const uint16_t> target;
  uint64_t seed = 0;
  float diagonal_m = 0;
  uint64_t number = 0;
  const EarlierRays* earlier = nullptr;  ///< null: nothing is known
  std::array<Cone, kCells> cell_cones = gather::cell_cones();

  /// `before`: what is known of the element's rays; null: nothing.
  void trace_element(size_t i, const EarlierElement* before, RayWork& work, TracedHits& out,
                     TracedTile& tile) const;
  void choose_again(size_t i, Vec3 origin, Samples samples, const EarlierElement& before,
                    RayWork& work) const;
  /// Inside of solids it is dark: paths along their walls, which are long, would bring nothing.
  void drop_enclosed_paths(size_t i, RayWork& work, const TracedHits& hits) const;
};

void Round::drop_enclosed_paths(size_t i, RayWork& work, const TracedHits& hits) const {
  if (work.near.paths.empty()) return;
  const transport::BacksSeen own{int(hits.samples[i]), int(hits.met_back[i]),
                                 int(hits.met_double_sided_back[i])};
  if (transport::is_enclosed(world.scene, tracer, elements, i, own, diagonal_m))
    std::erase_if(work.near.paths, [](const NearPath& path) { return path.hit.back_face; });
}

/// Traces all rays of the batch.
void trace_all(const trace::RayTracer& tracer, RayWork& work) {
  work.hits.resize(work.batch.rays.size());
  tracer.closest_hits(work.batch.rays, work.hits);
  if (!tracer.has_tints()) return;
  work.tint.assign(work.batch.rays.size(), {1, 1, 1});
  tracer.tint(work.batch.rays, work.hits, work.tint);
}

/// Finds the rays that may meet something else than in the earlier bake, and of those that were
/// followed on the ones that may bring something else. Of rays that escaped through something
/// coloured the colour is not known. All that do are in work.again then, and have directions in the
/// batch, which is filled unless there are none.
void Round::choose_again(size_t i, Vec3 origin, Samples samples, const EarlierElement& before,
                         RayWork& work) const {
  const Vec3 normal = elements.normal[i], geometric = elements.geometric_normal[i];
  const uint64_t cells = before.escaped
                             ? cells_towards(earlier->boxes, origin, normal, geometric, cell_cones)
                             : ~uint64_t(0);
  work.maybe.clear(), work.again.clear();
  work.marked.assign(samples.count(), 0);
  if (before.followed.empty())
    for (size_t k = next_followed(before.ends, 0); k < before.ends.size();
         k = next_followed(before.ends, k + 1))
      work.marked[k] = 1;
  else
    mark_followed(earlier->boxes, origin, before.near_m, before.ends, before.followed, work.marked);
  if (tracer.has_tints())
    for (size_t k = 0; k < before.ends.size(); ++k)
      if (before.ends[k] == RayEnd::escaped) work.marked[k] = 1;
  if (cells == 0 && std::ranges::find(work.marked, 1) == work.marked.end()) return;
  fill_samples(hash64(seed ^ 0x6a7e, i), samples, work.batch);
  for (uint32_t k = 0; k < samples.count(); ++k)
    if (work.marked[k] || cells >> work.batch.cell[k] & 1) work.maybe.push_back(k);
  fill_directions(origin, normal, geometric, work.maybe, work.batch);
  mark_rays(earlier->boxes, work.batch.rays, work.maybe, work.marked);
  for (const uint32_t k : work.maybe)
    if (work.marked[k]) work.again.push_back(k);
}

/// Traces work.again.
void trace_again(const trace::RayTracer& tracer, RayWork& work) {
  const size_t count = work.again.size();
  if (count == 0) return;
  const bool tinted = tracer.has_tints();
  work.few_rays.clear();
  for (const uint32_t k : work.again) work.few_rays.push_back(work.batch.rays[k]);
  work.few_hits.resize(count);
  tracer.closest_hits(work.few_rays, work.few_hits);
  work.few_tints.assign(count, {1, 1, 1});
  if (tinted) tracer.tint(work.few_rays, work.few_hits, work.few_tints);
  work.hits.resize(work.batch.rays.size());
  if (tinted) work.tint.assign(work.batch.rays.size(), {1, 1, 1});
  for (size_t at = 0; at < count; ++at) {
    work.hits[work.again[at]] = work.few_hits[at];
    if (tinted) work.tint[work.again[at]] = work.few_tints[at];
  }
}

void Round::trace_element(size_t i, const EarlierElement* before, RayWork& work, TracedHits& out,
                          TracedTile& tile) const {
  const Samples samples{out.samples[i], std::max(out.samples[i], target[i])};
  if (samples.count() == 0) {
    tile.rays_met.escaped.emplace_back(), tile.rays_met.near_m.emplace_back();
    return;
  }
  // What was there before is of the first half now.
  out.sky_first_less_second[i] = luminance(out.sky[i]);
  out.samples[i] = uint16_t(samples.end), out.last_round[i] = uint8_t(out.rounds.size());
  const Vec3 origin =
      trace::offset_origin(elements.position[i], elements.geometric_normal[i], diagonal_m);
  size_t traced = samples.count();
  if (before) {
    choose_again(i, origin, samples, *before, work);
    trace_again(tracer, work);
    traced = work.again.size();
    merge_rays(world, work, i, samples, *before, out, tile.rays_met);
  } else {
    fill_rays(origin, elements.normal[i], elements.geometric_normal[i], hash64(seed ^ 0x6a7e, i),
              samples, work.batch);
    trace_all(tracer, work);
    sort_rays(world, work, i, samples, out, tile.rays_met);
  }
  drop_enclosed_paths(i, work, out);
  tile.kept += samples.count() - traced;
  tile.rays += traced;
  tile.rays +=
      follow_on(world, work, i, samples, hash64(seed ^ 0x7ea4, i), before, out, tile.rays_met);
}

/// The most samples that the round adds to one element.
size_t most_added(std::span<const uint16_t> target, const TracedHits& hits) {
  size_t most = 0;
  for (size_t i = 0; i < target.size(); ++i) {
    if (target[i] <= hits.samples[i]) continue;
    const size_t added = size_t(target[i] - hits.samples[i]);
    LUXEL_CHECK(added >= hits.samples[i]);
    most = std::max(most, added);
  }
  return most;
}

/// How many samples some elements will get in a round.
uint64_t planned_samples(std::span<const uint16_t> target, const TracedHits& hits, size_t begin,
                         size_t end) {
  uint64_t planned = 0;
  for (size_t i = begin; i < end; ++i)
    planned += uint64_t(std::max(0, int(target[i]) - int(hits.samples[i])));
  return planned;
}

/// Takes the rays of a tile's elements one after another from what an earlier bake knew.
struct EarlierCursor {
  const RayTile* tile = nullptr;  ///< null: nothing is known
  size_t next_ray = 0, next_followed = 0;
  EarlierElement of{};

  /// Those of the tile's k-th element, whose rays are `count`. False: they are not known.
  bool advance(size_t k, size_t count, bool knows_escaped) {
    if (tile == nullptr || next_ray + count > tile->ends.size()) return false;
    const uint32_t first = k == 0 ? 0 : tile->hits.end[k - 1];
    const auto of_ends = std::span(tile->ends).subspan(next_ray, count);
    of = {of_ends, std::span(tile->hits.entries).subspan(first, tile->hits.end[k] - first),
          knows_escaped ? &tile->escaped[k] : nullptr,
          std::span(tile->followed)
              .subspan(next_followed, size_t(std::ranges::count(of_ends, RayEnd::followed))),
          tile->near_m[k]};
    next_ray += count, next_followed += of.followed.size();
    const auto hits = std::ranges::count_if(
        of.ends, [](RayEnd end) { return end == RayEnd::hit || end == RayEnd::behind; });
    const auto of_followed = std::ranges::count_if(of.followed, &FollowedRay::has_hit);
    return size_t(hits + of_followed) == of.hits.size();
  }
};

/// What tracing a tile needs, reused from tile to tile.
struct TileWork {
  RayWork work;
  RayTileBuffer earlier;
  TracedTile tile;
};

void clear(TracedTile& tile) {
  RayTile& rays = tile.rays_met;
  rays.ends.clear(), rays.escaped.clear(), rays.hits.end.clear(), rays.hits.entries.clear();
  rays.followed.clear(), rays.near_m.clear();
  tile.rays = tile.kept = 0;
}

/// What an earlier bake knew of the elements [begin, end); null: nothing.
const RayTile* earlier_tile(const Round& round, size_t begin, size_t end, uint64_t planned,
                            RayTileBuffer& buffer) {
  if (!round.earlier) return nullptr;
  const RayTile* rays = find_rays(*round.earlier->file, round.number, begin / kTileElements,
                                  end - begin, places_of(round.world.atlas), buffer);
  // Maybe of a round with other samples.
  return rays && rays->ends.size() == planned ? rays : nullptr;
}

/// Whether an element's rays that were followed on may bring what they brought, as far as lamps and
/// reflectances are concerned. They are not told apart by layers.
bool stay_followed(const Round& round, size_t element, float near_m) {
  const EarlierRays& earlier = *round.earlier;
  return earlier.same_light && !earlier.same_light_m.empty() && round.world.layers == nullptr &&
         near_m <= earlier.same_light_m[element];
}

/// Traces the elements [begin, end) into buffers.tile, unless the work is cancelled.
void trace_tile(const Round& round, size_t begin, size_t end, TileWork& buffers, TracedHits& hits,
                Progress& progress) {
  constexpr uint64_t kRaysPerAdvance = 8192;
  RayWork& work = buffers.work;
  TracedTile& tile = buffers.tile;
  clear(tile);
  uint64_t untold = 0, kept = 0;
  // Through glass rays escape in a colour that is not known.
  const bool knows_escaped =
      round.earlier && !round.earlier->surroundings && !round.tracer.has_tints();
  const uint64_t planned = planned_samples(round.target, hits, begin, end);
  EarlierCursor before{earlier_tile(round, begin, end, planned, buffers.earlier)};
  tile.rays_met.hits.entries.reserve(planned), tile.rays_met.ends.reserve(planned);
  for (size_t i = begin; i < end; ++i) {
    if (progress.cancelled()) return;
    const uint64_t samples = planned_samples(round.target, hits, i, i + 1);
    const bool known =
        before.advance(i - begin, samples, knows_escaped) && !round.earlier->moved[i];
    if (known && !stay_followed(round, i, before.of.near_m)) before.of.followed = {};
    round.trace_element(i, known ? &before.of : nullptr, work, hits, tile);
    tile.rays_met.hits.end.push_back(uint32_t(tile.rays_met.hits.entries.size()));
    // Not for every element: the counter is shared by all threads.
    untold += samples;
    if (untold < kRaysPerAdvance && i + 1 < end) continue;
    progress.skip(std::min(untold, tile.kept - kept));
    progress.advance(untold - std::min(untold, tile.kept - kept));
    untold = 0, kept = tile.kept;
  }
}

/// Traces the round's elements into `store`. Errors: disk full.
Status trace_tiles(const Round& round, const KeptStage& kept, PartStore* keep, TracedHits& hits,
                   HitStore& store, Progress& progress) {
  std::atomic<uint64_t> rays{0}, rays_kept{0};
  BufferPool<TileWork> pool;
  std::mutex mutex;
  Status status;
  const uint32_t places = places_of(round.world.atlas);
  parallel_for(hits.size(), kTileElements, [&](size_t begin, size_t end) {
    if (progress.cancelled()) return;
    const size_t number = begin / kTileElements;
    const uint64_t planned = planned_samples(round.target, hits, begin, end);
    Status put;
    if (std::optional<FoundTile> found = find_tile(kept, begin, end, places, hits)) {
      progress.skip(planned);
      rays += found->tile.rays;
      put = store.put(number, std::move(found->tile.rays_met.hits), found->entries);
    } else {
      TileWork work = pool.take();
      const TracedTile& tile = work.tile;
      trace_tile(round, begin, end, work, hits, progress);
      if (progress.cancelled()) return;
      const transport::KeptEntries entries = keep_tile(kept, begin, end, tile, hits);
      keep_rays(keep, round.number, number, tile.rays_met);
      rays += tile.rays, rays_kept += tile.kept;
      // A copy, without room to spare.
      put = store.put(number, HitTile(tile.rays_met.hits), entries);
      pool.give(std::move(work));
    }
    if (!put) {
      const std::lock_guard lock(mutex);
      if (status) status = put;
      progress.request_cancel();
    }
  });
  hits.rays += rays, hits.rays_kept += rays_kept;
  return status;
}

}  // namespace

Status trace_more(const scene::Scene& scene, const atlas::Atlas& atlas,
                  const transport::Elements& elements, const transport::Surroundings& around,
                  const trace::RayTracer& tracer, std::span<const uint16_t> target,
                  const TraceParams& params, TracedHits& hits, Progress& progress) {
  LUXEL_CHECK(target.size() == elements.size() && hits.size() == elements.size());
  LUXEL_CHECK(hits.rounds.size() < 256);
  LUXEL_CHECK(hits.sky_by_layer.size() ==
              elements.size() * (params.layers ? params.layers->size() : 0));
  const uint64_t used = hits.bytes_in_memory();
  LUXEL_TRY(HitStore store,
            HitStore::create(elements.size(), kTileElements, most_added(target, hits),
                             params.memory_limit_bytes - std::min(used, params.memory_limit_bytes),
                             params.scratch_folder));
  const float diagonal_m = scene::world_bounds(scene).diagonal();
  std::optional<NearWorld> near;
  std::vector<float> widths;
  if (params.near_lights != nullptr) {
    widths = texel_widths_m(scene, atlas);
    near.emplace(
        NearWorld{scene, atlas, *params.near_lights, tracer, widths, diagonal_m, params.layers});
  }
  const RayWorld world{scene, atlas, around, near ? &*near : nullptr, params.layers};
  const KeptStage kept = kept_round(hits, target, params);
  progress.begin("trace rays", planned_samples(target, hits, 0, target.size()));
  const uint64_t number = hits.rounds.size();
  LUXEL_TRY_STATUS(trace_tiles(
      {world, elements, tracer, target, params.seed, diagonal_m, number, params.earlier}, kept,
      params.keep, hits, store, progress));
  if (progress.cancelled()) return fail(ErrorCode::cancelled, "stopped by the user");
  keep_samples(params.keep, number, hits.samples);
  hits.rounds.push_back(std::move(store));
  return {};
}

Result<TracedHits> trace_hits(const scene::Scene& scene, const atlas::Atlas& atlas,
                              const transport::Elements& elements,
                              const transport::Surroundings& around, const trace::RayTracer& tracer,
                              int samples, const TraceParams& params, Progress& progress) {
  LUXEL_CHECK(samples >= 1 && samples <= 65535);
  TracedHits hits = no_hits(elements.size(), params.layers ? params.layers->size() : 0);
  const std::vector<uint16_t> target(elements.size(), uint16_t(samples));
  LUXEL_TRY_STATUS(
      trace_more(scene, atlas, elements, around, tracer, target, params, hits, progress));
  return hits;
}

}  // namespace luxel::gather
