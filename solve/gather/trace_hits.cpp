#include "solve/gather/trace_hits.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <mutex>
#include <optional>

#include "base/check.h"
#include "base/parallel.h"
#include "base/random.h"
#include "base/vectorize.h"
#include "scene/sides.h"
#include "solve/gather/kept_hits.h"
#include "solve/gather/near_paths.h"

namespace luxel::gather {
namespace {

/// Directions are sorted by cells of the unit square, 8 x 8 in Morton order.
constexpr int kCellsPerAxis = 8;
constexpr size_t kCells = size_t(kCellsPerAxis * kCellsPerAxis);

/// Everything a worker needs, reused from element to element.
struct Work {
  std::vector<float> u, v, x, y, z;
  std::vector<uint8_t> cell;
  std::vector<uint32_t> sample;  ///< of the element, per ray
  std::vector<trace::Ray> rays;
  std::vector<trace::Hit> hits;
  std::vector<Rgb> tint;  ///< of what rays have passed; empty where nothing has a colour
  NearWork near;

  void resize(size_t samples) {
    for (std::vector<float>* buffer : {&u, &v, &x, &y, &z}) buffer->resize(samples);
    cell.resize(samples), sample.resize(samples);
    rays.resize(samples), hits.resize(samples);
  }
};

/// Which samples of an element.
struct Samples {
  uint32_t first = 0, end = 0;

  uint32_t count() const { return end - first; }
  /// Whether a sample belongs to the second half of all up to `end`.
  bool in_second_half(uint32_t sample) const { return 2 * sample >= end; }
};

/// cos and sin of 2 pi x for x in [0, 1), to 2e-7: each quarter turn by Taylor's series about its
/// middle. Without branches, so that loops over it become vector code, which std::sin prevents.
inline Vec2 unit_circle(float x) {
  const float turns = 4 * x;
  const int quadrant = int(turns);
  const float t = (turns - float(quadrant) - 0.5f) * (0.5f * kPi);  // [-pi/4, pi/4)
  const float t2 = t * t;
  const float s = t * (1 + t2 * (-1.0f / 6 + t2 * (1.0f / 120 + t2 * (-1.0f / 5040))));
  const float c = 1 + t2 * (-0.5f + t2 * (1.0f / 24 + t2 * (-1.0f / 720 + t2 * (1.0f / 40320))));
  const float h = 0.70710678f;
  const float cosine = h * (c - s), sine = h * (c + s);  // turned by the missing eighth
  const float a = (quadrant & 1) ? -sine : cosine, b = (quadrant & 1) ? cosine : sine;
  const float sign = (quadrant & 2) ? -1.0f : 1.0f;
  return {a * sign, b * sign};
}

/// Directions about +z from the points (u, v), and the cell of each point.
LUXEL_VECTOR_CLONES
void local_directions(Work& work, size_t count) {
  const float* u = work.u.data();
  const float* v = work.v.data();
  float* x = work.x.data();
  float* y = work.y.data();
  float* z = work.z.data();
  for (size_t i = 0; i < count; ++i) {
    const Vec2 circle = unit_circle(u[i]);
    const float r = std::sqrt(v[i]);
    x[i] = circle.x * r, y[i] = circle.y * r, z[i] = std::sqrt(1 - v[i]);
  }
  uint8_t* cell = work.cell.data();
  for (size_t i = 0; i < count; ++i) {
    const int a = int(u[i] * kCellsPerAxis), b = int(v[i] * kCellsPerAxis);
    cell[i] =
        uint8_t((a & 1) | (a & 2) << 1 | (a & 4) << 2 | (b & 1) << 1 | (b & 2) << 2 | (b & 4) << 3);
  }
}

/// The rays of an element in the order of their cells (a counting sort).
void fill_rays(Vec3 origin, Vec3 normal, Vec3 geometric_normal, uint64_t seed, Samples samples,
               Work& work) {
  const uint32_t count = samples.count();
  work.resize(count);
  sobol_owen_2d_points(seed, work.u, work.v, samples.first);
  local_directions(work, count);
  std::array<uint32_t, kCells + 1> place{};
  for (uint32_t i = 0; i < count; ++i) ++place[work.cell[i] + 1];
  for (size_t c = 0; c < kCells; ++c) place[c + 1] += place[c];
  const Frame frame = frame_around(normal);
  const bool bent = !(normal == geometric_normal);
  for (uint32_t i = 0; i < count; ++i) {
    Vec3 d = frame.to_world({work.x[i], work.y[i], work.z[i]});
    if (bent) d = transport::mirrored_above(d, geometric_normal);
    const uint32_t at = place[work.cell[i]]++;
    work.rays[at] = {origin, 0, d, INFINITY};
    work.sample[at] = samples.first + i;
  }
}

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

/// Counts what the rays of an element's samples met, and keeps the hits that bring light.
void sort_hits(const World& world, Work& work, size_t element, Samples samples, TracedHits& out,
               HitTile& tile) {
  for (size_t k = 0; k < work.hits.size(); ++k) {
    const trace::Hit& hit = work.hits[k];
    const bool second_half = samples.in_second_half(work.sample[k]);
    if (!hit.found()) {
      ++out.escaped[element];
      Rgb l = transport::soft_radiance(world.scene, world.around, work.rays[k].direction);
      if (!work.tint.empty()) l = l * work.tint[k];
      add_light(l, second_half, element, out);
      add_sky(world, l, element, out);
      continue;
    }
    if (hit.back_face &&
        !scene::reflects_from_behind(scene::material_at(world.scene, hit.point()))) {
      ++out.met_back[element];
      continue;
    }
    if (hit.back_face) ++out.met_double_sided_back[element];
    if (world.near != nullptr) {
      NearPath path{work.sample[k], work.tint.empty() ? Rgb{1, 1, 1} : work.tint[k], {}, hit, {}};
      if (goes_on(*world.near, path)) {
        work.near.paths.push_back(path);
        continue;
      }
    }
    const uint32_t tint = work.tint.empty()
                              ? kNoTint
                              : pack_tint(work.tint[k], hash64(element, work.sample[k] ^ 0x7147u));
    tile.entries.push_back(store(world.atlas, hit.point(), {tint, second_half}));
  }
}

/// Follows the rays of an element on that ended nearby. Returns the number of rays.
uint64_t follow_on(const World& world, Work& work, size_t element, Samples samples, uint64_t seed,
                   TracedHits& out, HitTile& tile) {
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
    tile.entries.push_back(store(world.atlas, path.hit.point(), {tint, second_half}));
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

void element_rays(Vec3 origin, Vec3 normal, Vec3 geometric_normal, uint64_t seed,
                  std::span<trace::Ray> rays) {
  Work work;
  fill_rays(origin, normal, geometric_normal, seed, {0, uint32_t(rays.size())}, work);
  std::copy(work.rays.begin(), work.rays.end(), rays.begin());
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

  /// Returns the number of rays.
  uint64_t trace_element(size_t i, Work& work, TracedHits& out, HitTile& tile) const;
};

uint64_t Round::trace_element(size_t i, Work& work, TracedHits& out, HitTile& tile) const {
  const Samples samples{out.samples[i], std::max(out.samples[i], target[i])};
  if (samples.count() == 0) return 0;
  // What was there before is of the first half now.
  out.sky_first_less_second[i] = luminance(out.sky[i]);
  out.samples[i] = uint16_t(samples.end), out.last_round[i] = uint8_t(out.rounds.size());
  const Vec3 origin =
      trace::offset_origin(elements.position[i], elements.geometric_normal[i], diagonal_m);
  fill_rays(origin, elements.normal[i], elements.geometric_normal[i], hash64(seed ^ 0x6a7e, i),
            samples, work);
  tracer.closest_hits(work.rays, work.hits);
  if (tracer.has_tints()) {
    work.tint.assign(samples.count(), {1, 1, 1});
    tracer.tint(work.rays, work.hits, work.tint);
  }
  sort_hits(world, work, i, samples, out, tile);
  if (work.near.paths.empty()) return samples.count();
  return samples.count() + follow_on(world, work, i, samples, hash64(seed ^ 0x7ea4, i), out, tile);
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

/// Traces the elements [begin, end), unless the work is cancelled.
TracedTile trace_tile(const Round& round, size_t begin, size_t end, TracedHits& hits,
                      Progress& progress) {
  constexpr uint64_t kRaysPerAdvance = 8192;
  Work work;
  TracedTile tile;
  uint64_t untold = 0;
  tile.hits.entries.reserve(planned_samples(round.target, hits, begin, end));
  for (size_t i = begin; i < end; ++i) {
    if (progress.cancelled()) return tile;
    const uint64_t before = hits.samples[i];
    tile.rays += round.trace_element(i, work, hits, tile.hits);
    tile.hits.end.push_back(uint32_t(tile.hits.entries.size()));
    // Not for every element: the counter is shared by all threads.
    untold += hits.samples[i] - before;
    if (untold < kRaysPerAdvance && i + 1 < end) continue;
    progress.advance(untold);
    untold = 0;
  }
  return tile;
}

/// Traces the round's elements into `store`. Errors: disk full.
Status trace_tiles(const Round& round, const KeptStage& kept, TracedHits& hits, HitStore& store,
                   Progress& progress) {
  std::atomic<uint64_t> rays{0};
  std::mutex mutex;
  Status status;
  // StoredHit::base() of the last texel that has another below and to the right, plus one.
  const uint32_t side = uint32_t(round.world.atlas.resolution);
  const uint32_t places = (side + 2) * (side + 1) - 1;
  parallel_for(hits.size(), kTileElements, [&](size_t begin, size_t end) {
    if (progress.cancelled()) return;
    const uint64_t planned = planned_samples(round.target, hits, begin, end);
    std::optional<FoundTile> tile = find_tile(kept, begin, end, places, hits);
    if (tile) {
      progress.skip(planned);
    } else {
      tile.emplace(FoundTile{trace_tile(round, begin, end, hits, progress), {}});
      if (progress.cancelled()) return;
      tile->entries = keep_tile(kept, begin, end, tile->tile, hits);
    }
    rays += tile->tile.rays;
    const Status put = store.put(begin / kTileElements, std::move(tile->tile.hits), tile->entries);
    if (!put) {
      const std::lock_guard lock(mutex);
      if (status) status = put;
      progress.request_cancel();
    }
  });
  hits.rays += rays;
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
  LUXEL_TRY_STATUS(trace_tiles({world, elements, tracer, target, params.seed, diagonal_m}, kept,
                               hits, store, progress));
  if (progress.cancelled()) return fail(ErrorCode::cancelled, "stopped by the user");
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
