#include "luxel/solve/gather/trace/trace_hits.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>
#include <numeric>
#include <optional>

#include "luxel/base/buffer_pool.h"
#include "luxel/base/check.h"
#include "luxel/base/parallel.h"
#include "luxel/base/random.h"
#include "luxel/base/share_out.h"
#include "luxel/scene/sides.h"
#include "luxel/solve/gather/rays/element_rays.h"
#include "luxel/solve/gather/rays/own_tiles.h"
#include "luxel/solve/gather/rays/tile_hits.h"
#include "luxel/solve/gather/reuse/retraced_rays.h"
#include "luxel/solve/gather/trace/follow_on.h"
#include "luxel/solve/gather/trace/kept_hits.h"
#include "luxel/solve/gather/trace/scene_of_rays.h"
#include "luxel/solve/gather/trace/sort_rays.h"

namespace luxel::gather {

std::vector<StoredHit> places_behind(const transport::OwnSides& sides,
                                     const transport::Elements& elements) {
  std::vector<StoredHit> out(elements.transmittance.size());
  parallel_for(out.size(), 4096, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const scene::SurfacePoint& p = sides.map.texels[i].sample;
      const auto behind = scene::other_side_of(sides.scene, p).value_or(p);
      out[i] = store(transport::own_lookup(sides, behind), {});
    }
  });
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
  const RayScene& ray_scene;
  const transport::Elements& elements;
  const trace::RayTracer& tracer;
  std::span<const uint16_t> target;
  uint64_t seed = 0;
  uint64_t number = 0;
  const EarlierRays* earlier = nullptr;  ///< null: nothing is known
  const TileWatch* watch = nullptr;      ///< null: nobody
  std::span<const uint64_t> doubtful{};  ///< RetraceScene
  CellCones cell_cones = gather::cell_cones();

  Samples samples_of(size_t i, const TracedHits& hits) const {
    return {hits.samples[i], std::max(hits.samples[i], target[i])};
  }
  void fill_batch(size_t i, Samples samples, const TracedHits& hits, RayBatch& batch) const;
  /// The rays that are known of the tile of elements [begin, end), and what those of them meet that
  /// are traced again.
  void trace_known(size_t begin, size_t end, const RayTile* known, const TracedHits& hits,
                   RayBuffers& buffers, RetracedRays& out) const;
  /// `before`: what is known of the element's rays, and buffers.retraced has been traced; null:
  /// nothing.
  void trace_element(size_t i, const EarlierElement* before, RayBuffers& buffers, TracedHits& out,
                     TracedTile& tile) const;
};

void Round::fill_batch(size_t i, Samples samples, const TracedHits& hits, RayBatch& batch) const {
  const Vec3 from = elements.position[i], n = elements.normal[i],
             flat = elements.geometric_normal[i];
  if (is_guided(hits, i)) {
    const CellShares shares =
        shares_at(hits.guide.groups[hits.guide.of_element[i]], hits.guided[i]);
    return fill_rays(from, n, flat, seed_of_rays(seed_of_guided_rays(seed), i), samples, shares,
                     batch);
  }
  fill_rays(from, n, flat, seed_of_rays(seed, i), samples, batch);
}

/// Traces all rays of the batch.
void trace_all(const trace::RayTracer& tracer, RayBuffers& buffers) {
  buffers.hits.resize(buffers.batch.rays.size());
  tracer.closest_hits(buffers.batch.rays, buffers.hits, trace::Packets::alike);
  if (!tracer.has_tints()) return;
  buffers.tint.assign(buffers.batch.rays.size(), {1, 1, 1});
  tracer.tint(buffers.batch.rays, buffers.hits, buffers.tint);
}

void Round::trace_element(size_t i, const EarlierElement* before, RayBuffers& buffers,
                          TracedHits& out, TracedTile& tile) const {
  const Samples samples = samples_of(i, out);
  if (samples.count() == 0) {
    tile.rays_met.escaped.emplace_back();
    return;
  }
  // Light that was there before is of the first half now.
  out.sky_first_less_second[i] = luminance(out.sky[i]);
  out.samples[i] = uint16_t(samples.end), out.last_round[i] = uint8_t(out.rounds.size());
  if (ray_scene.sent && !(before && before->escaped)) out.unknown[i] = 1;
  size_t traced = samples.count();
  if (before) {
    traced = buffers.retraced.size();
    if (!before->escaped) fill_batch(i, samples, out, buffers.batch);
    merge_rays(ray_scene, buffers, i, samples, *before, out, tile.rays_met);
  } else {
    fill_batch(i, samples, out, buffers.batch);
    traced = buffers.batch.rays.size();
    trace_all(tracer, buffers);
    sort_rays(ray_scene, buffers, i, samples, out, tile.rays_met);
  }
  if (!is_guided(out, i)) out.counted[i] = out.samples[i];
  drop_enclosed_paths(ray_scene, elements, i, out, buffers.near);
  tile.kept += before ? samples.count() - traced : 0;
  tile.rays += traced;
}

/// The most rays that the round adds to one element.
size_t most_added(std::span<const uint16_t> target, const TracedHits& hits) {
  size_t most = 0;
  for (size_t i = 0; i < target.size(); ++i) {
    if (target[i] <= hits.samples[i]) continue;
    const size_t added = size_t(target[i] - hits.samples[i]);
    LUXEL_CHECK(added >= hits.samples[i]);
    // Where an element has fewer samples than cells, some cells have more of them than others.
    const size_t uneven = is_guided(hits, i) ? kCells : 0;
    const double rays = std::ceil(double(added + uneven) * double(rays_per_sample(hits, i)));
    most = std::max(most, size_t(rays));
  }
  return most;
}

/// Samples that the elements [begin, end) will get in a round.
uint64_t planned_samples(std::span<const uint16_t> target, const TracedHits& hits, size_t begin,
                         size_t end) {
  uint64_t planned = 0;
  for (size_t i = begin; i < end; ++i)
    planned += uint64_t(std::max(0, int(target[i]) - int(hits.samples[i])));
  return planned;
}

/// Buffers for tracing a tile, reused from tile to tile.
struct TileBuffers {
  RayBuffers rays;
  RayTileBuffer earlier;
  RetracedRays retraced;
  TracedTile tile;
};

void clear(TracedTile& tile) {
  RayTile& rays = tile.rays_met;
  rays.ends.clear(), rays.escaped.clear(), rays.hits.end.clear(), rays.hits.entries.clear();
  rays.followed.clear(), rays.near_m.clear();
  tile.rays = tile.kept = 0;
}

/// Rays of the elements [begin, end) in an earlier bake; null: none are known.
const RayTile* earlier_tile(const Round& round, size_t begin, size_t end, uint64_t planned,
                            RayTileBuffer& buffer) {
  if (!round.earlier) return nullptr;
  const RayTile* rays = find_rays(*round.earlier->file, round.number, begin / kTileElements,
                                  end - begin, places_of(round.ray_scene.atlas), buffer);
  // Maybe of a round with other samples.
  return rays && rays->ends.size() == planned ? rays : nullptr;
}

/// True: an element's followed rays may bring what they brought, as far as lights and reflectances
/// are concerned. False with layers, by which kept light is not told apart.
bool stay_followed(const Round& round, size_t element, float near_m) {
  const EarlierRays& earlier = *round.earlier;
  return earlier.same_light && !earlier.same_light_m.empty() && round.ray_scene.layers == nullptr &&
         near_m <= earlier.same_light_m[element];
}

void Round::trace_known(size_t begin, size_t end, const RayTile* known, const TracedHits& hits,
                        RayBuffers& buffers, RetracedRays& out) const {
  // Through glass rays escape in a colour that is not known.
  const bool knows_escaped = !earlier->surroundings && !tracer.has_tints();
  clear(out);
  EarlierCursor cursor{known};
  for (size_t i = begin; i < end; ++i) {
    const Samples samples = samples_of(i, hits);
    const bool knows = cursor.advance(i - begin, samples.count(), knows_escaped) &&
                       !earlier->moved[i] && samples.count() > 0;
    buffers.retraced.clear();
    if (knows) {
      cursor.of.follows_again = !stay_followed(*this, i, cursor.of.near_m);
      choose_retraced({elements, *earlier, cell_cones, tracer.has_tints(), doubtful}, i,
                      elements.position[i], seed_of_rays(seed, i), samples, cursor.of, buffers);
    }
    add_retraced(knows ? &cursor.of : nullptr, buffers, out);
  }
  retrace(tracer, out);
}

/// Traces the elements [begin, end) into buffers.tile, unless the work is cancelled.
void trace_tile(const Round& round, size_t begin, size_t end, TileBuffers& tile_buffers,
                TracedHits& hits, Progress& progress) {
  constexpr uint64_t kRaysPerAdvance = 8192;
  RayBuffers& buffers = tile_buffers.rays;
  TracedTile& tile = tile_buffers.tile;
  // The tile's own are given away each time.
  std::swap(tile.rays_met.hits, buffers.other_hits);
  clear(tile);
  buffers.near.paths.clear(), buffers.followed.clear(), buffers.ends_of.clear();
  uint64_t untold = 0, kept = 0;
  const uint64_t planned = planned_samples(round.target, hits, begin, end);
  const RayTile* known = earlier_tile(round, begin, end, planned, tile_buffers.earlier);
  if (known) round.trace_known(begin, end, known, hits, buffers, tile_buffers.retraced);
  tile.rays_met.hits.entries.reserve(planned), tile.rays_met.ends.reserve(planned);
  for (size_t i = begin; i < end; ++i) {
    if (progress.cancelled()) return;
    const uint64_t samples = planned_samples(round.target, hits, i, i + 1);
    const EarlierElement* before = known ? tile_buffers.retraced.of(i - begin) : nullptr;
    if (before) take_retraced(tile_buffers.retraced, i - begin, buffers);
    round.trace_element(i, before, buffers, hits, tile);
    tile.rays_met.hits.end.push_back(uint32_t(tile.rays_met.hits.entries.size()));
    buffers.ends_of.push_back(uint32_t(tile.rays_met.ends.size()));
    if (buffers.near.paths.size() >= kPathsAtATime)
      tile.rays += follow_paths(round.ray_scene, buffers, hits);
    // Not for every element: the counter is shared by all threads.
    untold += samples;
    if (untold < kRaysPerAdvance && i + 1 < end) continue;
    progress.skip(std::min(untold, tile.kept - kept));
    progress.advance(untold - std::min(untold, tile.kept - kept));
    untold = 0, kept = tile.kept;
  }
  tile.rays += follow_on(round.ray_scene, begin, buffers.ends_of,
                         known ? &tile_buffers.retraced : nullptr, buffers, hits, tile.rays_met);
}

/// A round's way through its tiles, on several threads.
struct TileRound {
  const Round& round;
  const KeptStage& kept;
  PartStore* keep = nullptr;
  TracedHits& hits;
  HitStore& store;
  Progress& progress;
  uint32_t places = 0;
  std::vector<uint64_t> rays;  ///< per tile
  std::atomic<uint64_t> rays_kept{0};
  BufferPool<TileBuffers> pool{};
  std::mutex mutex{};
  Status status{};

  void make(size_t tile);
  Status make_one(size_t tile);
};

/// Traces or finds a tile. Errors: disk full.
Status TileRound::make_one(size_t number) {
  const size_t begin = number * kTileElements, end = std::min(begin + kTileElements, hits.size());
  const uint64_t planned = planned_samples(round.target, hits, begin, end);
  if (std::optional<FoundTile> found = find_tile(kept, begin, end, places, round.target, hits)) {
    progress.skip(planned);
    rays[number] = found->tile.rays;
    if (round.watch) round.watch->on_tile(begin, found->tile.rays_met.hits);
    return store.put(number, std::move(found->tile.rays_met.hits), found->entries);
  }
  if (kept.leaves(number)) {
    progress.skip(planned);
    return {};
  }
  TileBuffers buffers = pool.take();
  TracedTile& tile = buffers.tile;
  trace_tile(round, begin, end, buffers, hits, progress);
  if (progress.cancelled()) return {};
  const KeptEntries entries = keep_tile(kept, number, tile, hits);
  keep_rays(keep, round.number, number, tile.rays_met);
  rays[number] = tile.rays, rays_kept += tile.kept;
  if (round.watch) round.watch->on_tile(begin, tile.rays_met.hits);
  const Status put = store.put(number, std::move(tile.rays_met.hits), entries);
  pool.give(std::move(buffers));
  return put;
}

/// The work ends when a tile fails.
void TileRound::make(size_t tile) {
  const Status made = make_one(round.watch ? round.watch->queue->next() : tile);
  if (made) return;
  const std::lock_guard lock(mutex);
  if (status) status = made;
  progress.request_cancel();
}

/// Gives all members of the team what rays of own tiles have met, but for the hits. Errors: those
/// of exchange().
Status give_counts(Team* team, std::span<const uint32_t> own, TileRound& tiles) {
  TracedHits& hits = tiles.hits;
  return exchange(team, own,
                  {tile_count(hits),
                   [&](size_t t, ByteWriter& out) {
                     out.put_value(tiles.rays[t]);
                     put_counts(hits, t, out);
                   },
                   [&](size_t t, uint32_t rank, ByteReader& in) {
                     hits.owner[t] = rank;
                     tiles.rays[t] = in.get_value<uint64_t>();
                     return get_counts(in, t, hits);
                   }},
                  tiles.progress);
}

/// Traces the round's elements into `store`. Whoever traces a tile of a team first has it in later
/// rounds. Errors: disk full, cancelled, another member of the team gives up.
Status trace_tiles(const Round& round, const TraceParams& params, const KeptStage& kept,
                   TracedHits& hits, HitStore& store, Progress& progress) {
  const size_t count = tile_count(hits);
  Team* const team = params.team;
  TileRound tiles{round,
                  kept,
                  params.keep,
                  hits,
                  store,
                  progress,
                  places_of(round.ray_scene.atlas),
                  std::vector<uint64_t>(count)};
  const auto make = [&](size_t tile) { tiles.make(tile); };
  std::vector<uint32_t> own;
  Status done;
  if (hits.team) {
    own = own_tiles(hits);
    done = do_own(team, own, progress, make);
  } else {
    auto shared_out = share_out(team, count, progress, make);
    if (shared_out)
      own = std::move(*shared_out);
    else
      done = Failure{shared_out.error()};
  }
  LUXEL_TRY_STATUS(tiles.status);
  LUXEL_TRY_STATUS(done);
  if (team && !hits.team) {
    hits.team = team, hits.owner.assign(count, 0);
    for (const uint32_t t : own) hits.owner[t] = team->rank();
  }
  LUXEL_TRY_STATUS(give_counts(team, own, tiles));
  hits.rays += std::accumulate(tiles.rays.begin(), tiles.rays.end(), uint64_t(0));
  hits.rays_kept += tiles.rays_kept;
  return {};
}

}  // namespace

Status trace_more(const TraceScene& in, std::span<const uint16_t> target, const TraceParams& params,
                  TracedHits& hits, Progress& progress) {
  const transport::Elements& elements = in.elements;
  LUXEL_CHECK(target.size() == elements.size() && hits.size() == elements.size());
  LUXEL_CHECK(hits.rounds.size() < 256);
  LUXEL_CHECK(!params.team || !(params.keep || params.earlier || params.watch));
  LUXEL_CHECK(hits.rounds.empty() || hits.team == params.team);
  LUXEL_CHECK(hits.guide.of_element.empty() || !(params.keep || params.earlier));
  LUXEL_CHECK(hits.sky_by_layer.size() ==
              elements.size() * (params.layers ? params.layers->size() : 0));
  // Hits of this round go to memory as far as those of the rounds before leave room.
  const uint64_t used = hits.bytes_in_memory();
  LUXEL_TRY(
      HitStore store,
      HitStore::create(elements.size(), kTileElements, most_added(target, hits),
                       params.memory_limit_bytes - std::min(used, params.memory_limit_bytes),
                       params.scratch_folder,
                       params.team ? TilesInMemory::first_come : TilesInMemory::first_numbers));
  const SceneOfRays scene(in, params);
  if (scene.rays().sent) hits.change.resize(elements.size()), hits.unknown.resize(elements.size());
  std::vector<uint64_t> doubtful;
  if (in.sides && params.earlier && !params.earlier->boxes.empty())
    doubtful = transport::lookups_near(*in.sides, params.earlier->boxes);
  const KeptStage kept = kept_round(hits, target, params);
  progress.begin("trace rays", planned_samples(target, hits, 0, target.size()));
  const uint64_t number = hits.rounds.size();
  LUXEL_TRY_STATUS(trace_tiles({scene.rays(), elements, in.tracer, target, params.seed, number,
                                params.earlier, params.watch, doubtful},
                               params, kept, hits, store, progress));
  keep_samples(params.keep, number, hits.samples);
  hits.rounds.push_back(std::move(store));
  return {};
}

Result<TracedHits> trace_hits(const TraceScene& in, int samples, const TraceParams& params,
                              Progress& progress) {
  LUXEL_CHECK(samples >= 1 && samples <= 65535);
  const size_t n = in.elements.size();
  TracedHits hits = no_hits(n, params.layers ? params.layers->size() : 0);
  const std::vector<uint16_t> target(n, uint16_t(samples));
  LUXEL_TRY_STATUS(trace_more(in, target, params, hits, progress));
  return hits;
}

}  // namespace luxel::gather
