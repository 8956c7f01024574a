#include "solve/gather/trace_hits.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <mutex>
#include <optional>

#include "base/check.h"
#include "base/parallel.h"
#include "base/random.h"
#include "scene/sides.h"
#include "solve/gather/element_rays.h"
#include "solve/gather/kept_hits.h"
#include "solve/gather/near_paths.h"
#include "transport/backs_seen.h"

namespace luxel::gather {
namespace {

/// Everything a worker needs, reused from element to element.
struct Work {
  RayBatch batch;
  std::vector<trace::Hit> hits;  ///< of the batch's rays
  std::vector<Rgb> tint;         ///< of what rays have passed; empty where nothing has a colour
  NearWork near;
  /// Where rays of an earlier bake are known: 1 for those that are traced again, and those alone.
  std::vector<uint8_t> again;
  std::vector<uint32_t> maybe;  ///< those that have a direction
  std::vector<trace::Ray> few_rays;
  std::vector<trace::Hit> few_hits;
  std::vector<Rgb> few_tints;
};

/// An element's rays of an earlier bake.
struct EarlierElement {
  std::span<const RayEnd> ends;
  std::span<const StoredHit> hits;
  /// Light of those that escaped, as they would see it now; null: not known.
  const EscapedLight* escaped = nullptr;
};

StoredHit store(const atlas::Atlas& atlas, const scene::SurfacePoint& p, StoredHit::Ray ray) {
  const auto& corners = atlas.corners[atlas.triangle_number(p.instance, p.triangle)];
  const Vec2 at = interpolate(corners[0], corners[1], corners[2], p.at);
  const float limit = float(atlas.resolution);
  const float x = std::clamp(at.x, 0.0f, limit) + 0.5f, y = std::clamp(at.y, 0.0f, limit) + 0.5f;
  const uint32_t x0 = uint32_t(x), y0 = uint32_t(y);  // with the border of one texel
  constexpr float kSteps = float(StoredHit::kSteps);
  return StoredHit::pack(y0 * uint32_t(atlas.resolution + 2) + x0,
                         uint32_t((x - float(x0)) * kSteps + 0.5f),
                         uint32_t((y - float(y0)) * kSteps + 0.5f), ray);
}

/// What rays meet, and what they see beyond.
struct World {
  const scene::Scene& scene;
  const atlas::Atlas& atlas;
  const transport::Surroundings& around;
  const NearWorld* near = nullptr;  ///< null: rays are not followed on
  const transport::LightLayers* layers = nullptr;
};

/// Adds radiance that a ray has brought without the map.
void add_light(Rgb l, bool second_half, size_t element, TracedHits& out) {
  out.sky[element] += l;
  out.sky_luminance2[element] += luminance(l) * luminance(l);
  out.sky_first_less_second[element] += second_half ? -luminance(l) : luminance(l);
}

/// Radiance of a ray that has left the scene.
void add_sky(const World& world, Rgb l, size_t element, TracedHits& out) {
  if (world.layers && world.layers->of_surroundings)
    out.sky_by_layer[element * world.layers->size() + *world.layers->of_surroundings] += l;
}

/// Counts a ray's end.
void count_end(RayEnd end, size_t element, TracedHits& out) {
  if (end == RayEnd::back) ++out.met_back[element];
  if (end == RayEnd::behind) ++out.met_double_sided_back[element];
  if (end == RayEnd::escaped) ++out.escaped[element];
}

/// What the batch's k-th ray sees outside, when it has escaped.
Rgb light_outside(const World& world, const Work& work, size_t k, bool tinted) {
  const Rgb l = transport::soft_radiance(world.scene, world.around, work.batch.rays[k].direction);
  return tinted && !work.tint.empty() ? l * work.tint[k] : l;
}

/// The same for all rays of an element, from what was known and what has changed.
EscapedLight escaped_light(const World& world, const Work& work, Samples samples,
                           const EarlierElement* before, std::span<const RayEnd> ends) {
  const bool known = before && before->escaped;
  EscapedLight out = known ? *before->escaped : EscapedLight{};
  for (size_t k = 0; k < ends.size(); ++k) {
    if (known && !work.again[k]) continue;
    const bool second_half = samples.in_second_half(work.batch.sample[k]);
    if (known && before->ends[k] == RayEnd::escaped)
      out.take_away(light_outside(world, work, k, false), second_half);
    if (ends[k] == RayEnd::escaped) out.add(light_outside(world, work, k, true), second_half);
  }
  out.sum = max(out.sum, Rgb{});
  return out;
}

/// How the batch's k-th ray has ended; one to be followed on is added to work.near.paths.
RayEnd end_of(const World& world, Work& work, size_t k) {
  const trace::Hit& hit = work.hits[k];
  if (!hit.found()) return RayEnd::escaped;
  if (hit.back_face && !scene::reflects_from_behind(scene::material_at(world.scene, hit.point())))
    return RayEnd::back;
  if (world.near != nullptr) {
    const NearPath path{
        work.batch.sample[k], work.tint.empty() ? Rgb{1, 1, 1} : work.tint[k], {}, hit, {}};
    if (goes_on(*world.near, path)) {
      work.near.paths.push_back(path);
      return RayEnd::followed;
    }
  }
  return hit.back_face ? RayEnd::behind : RayEnd::hit;
}

/// Counts what the rays of an element's samples met, and keeps the hits that bring light. `before`:
/// what they met in an earlier bake, but for work.again.
void sort_hits(const World& world, Work& work, size_t element, Samples samples,
               const EarlierElement* before, TracedHits& out, RayTile& tile) {
  size_t hits_before = 0;
  for (size_t k = 0; k < work.batch.rays.size(); ++k) {
    const bool second_half = samples.in_second_half(work.batch.sample[k]);
    const RayEnd known = before ? before->ends[k] : RayEnd::followed;
    const bool was_hit = known == RayEnd::hit || known == RayEnd::behind;
    const size_t hit_before = was_hit ? hits_before++ : 0;
    const bool keeps = before && !work.again[k];
    const RayEnd end = keeps ? known : end_of(world, work, k);
    tile.ends.push_back(end);
    if (end == RayEnd::followed) {
      if (work.near.paths.back().hit.back_face) ++out.met_double_sided_back[element];
      continue;
    }
    count_end(end, element, out);
    if (end != RayEnd::hit && end != RayEnd::behind) continue;
    if (keeps) {
      tile.hits.entries.push_back(before->hits[hit_before]);
      continue;
    }
    const uint32_t tint =
        work.tint.empty()
            ? kNoTint
            : pack_tint(work.tint[k], hash64(element, work.batch.sample[k] ^ 0x7147u));
    tile.hits.entries.push_back(store(world.atlas, work.hits[k].point(), {tint, second_half}));
  }
  const std::span<const RayEnd> ends = std::span(tile.ends).last(work.batch.rays.size());
  tile.escaped.push_back(escaped_light(world, work, samples, before, ends));
  const EscapedLight& light = tile.escaped.back();
  out.sky[element] += light.sum, out.sky_luminance2[element] += light.luminance2;
  out.sky_first_less_second[element] += luminance(light.sum) - 2 * light.second_luminance;
  add_sky(world, light.sum, element, out);
}

/// Follows the rays of an element on that ended nearby. Returns the number of rays.
uint64_t follow_on(const World& world, Work& work, size_t element, Samples samples, uint64_t seed,
                   TracedHits& out, RayTile& tile) {
  if (world.layers)
    work.near.by_layer =
        std::span(out.sky_by_layer).subspan(element * world.layers->size(), world.layers->size());
  return follow_near(*world.near, seed, work.near, [&](const NearPath& path) {
    const bool second_half = samples.in_second_half(path.sample);
    Rgb light = path.light;
    const bool alive = max_component(path.throughput) > 0;
    if (alive && !path.hit.found()) {
      const Rgb l =
          path.throughput * transport::soft_radiance(world.scene, world.around, path.direction);
      add_sky(world, l, element, out);
      light += l;
    }
    add_light(light, second_half, element, out);
    if (!alive || !path.hit.found()) return;
    if (path.hit.back_face &&
        !scene::reflects_from_behind(scene::material_at(world.scene, path.hit.point())))
      return;
    const uint32_t tint = pack_tint(path.throughput, hash64(seed, path.sample ^ 0x4e37u));
    tile.hits.entries.push_back(store(world.atlas, path.hit.point(), {tint, second_half}));
  });
}

}  // namespace

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

/// One round's way through the elements.
struct Round {
  const World& world;
  const transport::Elements& elements;
  const trace::RayTracer& tracer;
  std::span<const uint16_t> target;
  uint64_t seed = 0;
  float diagonal_m = 0;
  uint64_t number = 0;
  const EarlierRays* earlier = nullptr;  ///< null: nothing is known
  std::array<Cone, kCells> cell_cones = gather::cell_cones();

  /// `before`: what is known of the element's rays; null: nothing.
  void trace_element(size_t i, const EarlierElement* before, Work& work, TracedHits& out,
                     TracedTile& tile) const;
  void choose_again(size_t i, Vec3 origin, Samples samples, const EarlierElement& before,
                    Work& work) const;
  /// Inside of solids it is dark: paths along their walls, which are long, would bring nothing.
  void drop_enclosed_paths(size_t i, Work& work, const TracedHits& hits) const;
};

void Round::drop_enclosed_paths(size_t i, Work& work, const TracedHits& hits) const {
  if (work.near.paths.empty()) return;
  const transport::BacksSeen own{int(hits.samples[i]), int(hits.met_back[i]),
                                 int(hits.met_double_sided_back[i])};
  if (transport::is_enclosed(world.scene, tracer, elements, i, own, diagonal_m))
    std::erase_if(work.near.paths, [](const NearPath& path) { return path.hit.back_face; });
}

/// Traces all rays of the batch.
void trace_all(const trace::RayTracer& tracer, Work& work) {
  work.hits.resize(work.batch.rays.size());
  tracer.closest_hits(work.batch.rays, work.hits);
  if (!tracer.has_tints()) return;
  work.tint.assign(work.batch.rays.size(), {1, 1, 1});
  tracer.tint(work.batch.rays, work.hits, work.tint);
}

/// Fills the batch, with directions of those rays at least that may meet something else than in the
/// earlier bake, and those that are followed on: what they bring depends on reflectances and lamps.
/// Of rays that escaped through something coloured the colour is not known. Marks them in
/// work.again.
void Round::choose_again(size_t i, Vec3 origin, Samples samples, const EarlierElement& before,
                         Work& work) const {
  const Vec3 normal = elements.normal[i], geometric = elements.geometric_normal[i];
  const uint64_t seed_of_element = hash64(seed ^ 0x6a7e, i);
  fill_samples(seed_of_element, samples, work.batch);
  // Directions that are mirrored above the triangle are not where their cells are.
  const uint64_t cells = normal == geometric && before.escaped
                             ? cells_towards(earlier->boxes, origin, normal, cell_cones)
                             : ~uint64_t(0);
  work.again.assign(samples.count(), 0);
  work.maybe.clear();
  for (uint32_t k = 0; k < samples.count(); ++k) {
    const RayEnd end = before.ends[k];
    if (end == RayEnd::followed || (end == RayEnd::escaped && tracer.has_tints()))
      work.again[k] = 1;
    if (work.again[k] || cells >> work.batch.cell[k] & 1) work.maybe.push_back(k);
  }
  fill_directions(origin, normal, geometric, work.maybe, work.batch);
  mark_rays(earlier->boxes, work.batch.rays, work.maybe, work.again);
}

/// Traces the rays that are marked. Returns how many there were.
size_t trace_marked(const trace::RayTracer& tracer, Work& work) {
  const std::span<const trace::Ray> rays = work.batch.rays;
  const bool tinted = tracer.has_tints();
  work.few_rays.clear();
  for (const uint32_t k : work.maybe)
    if (work.again[k]) work.few_rays.push_back(rays[k]);
  const size_t count = work.few_rays.size();
  work.few_hits.resize(count);
  tracer.closest_hits(work.few_rays, work.few_hits);
  work.few_tints.assign(count, {1, 1, 1});
  if (tinted) tracer.tint(work.few_rays, work.few_hits, work.few_tints);
  work.hits.resize(rays.size());
  if (tinted) work.tint.assign(rays.size(), {1, 1, 1});
  size_t at = 0;
  for (const uint32_t k : work.maybe) {
    if (!work.again[k]) continue;
    work.hits[k] = work.few_hits[at];
    if (tinted) work.tint[k] = work.few_tints[at];
    ++at;
  }
  return count;
}

void Round::trace_element(size_t i, const EarlierElement* before, Work& work, TracedHits& out,
                          TracedTile& tile) const {
  const Samples samples{out.samples[i], std::max(out.samples[i], target[i])};
  if (samples.count() == 0) {
    tile.rays_met.escaped.emplace_back();
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
    traced = trace_marked(tracer, work);
  } else {
    fill_rays(origin, elements.normal[i], elements.geometric_normal[i], hash64(seed ^ 0x6a7e, i),
              samples, work.batch);
    trace_all(tracer, work);
  }
  sort_hits(world, work, i, samples, before, out, tile.rays_met);
  drop_enclosed_paths(i, work, out);
  tile.kept += samples.count() - traced;
  tile.rays += traced;
  if (!work.near.paths.empty())
    tile.rays += follow_on(world, work, i, samples, hash64(seed ^ 0x7ea4, i), out, tile.rays_met);
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
  size_t next_ray = 0;
  EarlierElement of{};

  /// Those of the tile's k-th element, whose rays are `count`. False: they are not known.
  bool advance(size_t k, size_t count, bool knows_escaped) {
    if (tile == nullptr || next_ray + count > tile->ends.size()) return false;
    const uint32_t first = k == 0 ? 0 : tile->hits.end[k - 1];
    of = {std::span(tile->ends).subspan(next_ray, count),
          std::span(tile->hits.entries).subspan(first, tile->hits.end[k] - first),
          knows_escaped ? &tile->escaped[k] : nullptr};
    next_ray += count;
    const auto hits = std::ranges::count_if(
        of.ends, [](RayEnd end) { return end == RayEnd::hit || end == RayEnd::behind; });
    return size_t(hits) <= of.hits.size();
  }
};

/// Traces the elements [begin, end), unless the work is cancelled.
TracedTile trace_tile(const Round& round, size_t begin, size_t end, const RayTile* earlier,
                      TracedHits& hits, Progress& progress) {
  constexpr uint64_t kRaysPerAdvance = 8192;
  Work work;
  TracedTile tile;
  EarlierCursor before{earlier};
  uint64_t untold = 0, kept = 0;
  // Through glass rays escape in a colour that is not known.
  const bool knows_escaped = earlier && !round.earlier->surroundings && !round.tracer.has_tints();
  const uint64_t planned = planned_samples(round.target, hits, begin, end);
  tile.rays_met.hits.entries.reserve(planned), tile.rays_met.ends.reserve(planned);
  for (size_t i = begin; i < end; ++i) {
    if (progress.cancelled()) return tile;
    const uint64_t samples = planned_samples(round.target, hits, i, i + 1);
    const bool known =
        before.advance(i - begin, samples, knows_escaped) && !round.earlier->moved[i];
    round.trace_element(i, known ? &before.of : nullptr, work, hits, tile);
    tile.rays_met.hits.end.push_back(uint32_t(tile.rays_met.hits.entries.size()));
    // Not for every element: the counter is shared by all threads.
    untold += samples;
    if (untold < kRaysPerAdvance && i + 1 < end) continue;
    progress.skip(std::min(untold, tile.kept - kept));
    progress.advance(untold - std::min(untold, tile.kept - kept));
    untold = 0, kept = tile.kept;
  }
  return tile;
}

/// Traces the round's elements into `store`. Errors: disk full.
Status trace_tiles(const Round& round, const KeptStage& kept, PartStore* keep, TracedHits& hits,
                   HitStore& store, Progress& progress) {
  std::atomic<uint64_t> rays{0}, rays_kept{0};
  std::mutex mutex;
  Status status;
  // StoredHit::base() of the last texel that has another below and to the right, plus one.
  const uint32_t side = uint32_t(round.world.atlas.resolution);
  const uint32_t places = (side + 2) * (side + 1) - 1;
  parallel_for(hits.size(), kTileElements, [&](size_t begin, size_t end) {
    if (progress.cancelled()) return;
    const size_t number = begin / kTileElements;
    const uint64_t planned = planned_samples(round.target, hits, begin, end);
    std::optional<FoundTile> tile = find_tile(kept, begin, end, places, hits);
    if (tile) {
      progress.skip(planned);
    } else {
      std::optional<RayTile> earlier;
      if (round.earlier)
        earlier = find_rays(*round.earlier->file, round.number, number, end - begin, places);
      tile.emplace(FoundTile{
          trace_tile(round, begin, end, earlier ? &*earlier : nullptr, hits, progress), {}});
      if (progress.cancelled()) return;
      tile->entries = keep_tile(kept, begin, end, tile->tile, hits);
      keep_rays(keep, round.number, number, tile->tile.rays_met);
    }
    rays += tile->tile.rays, rays_kept += tile->tile.kept;
    const Status put = store.put(number, std::move(tile->tile.rays_met.hits), tile->entries);
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
  const World world{scene, atlas, around, near ? &*near : nullptr, params.layers};
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
