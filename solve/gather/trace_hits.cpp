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
  std::vector<uint8_t> second_half;  ///< per ray
  std::vector<trace::Ray> rays;
  std::vector<trace::Hit> hits;
  std::vector<Rgb> tint;  ///< of what rays have passed; empty where nothing has a colour
  NearWork near;

  explicit Work(size_t samples)
      : u(samples),
        v(samples),
        x(samples),
        y(samples),
        z(samples),
        cell(samples),
        second_half(samples),
        rays(samples),
        hits(samples) {}
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
void fill_rays(Vec3 origin, Vec3 normal, Vec3 geometric_normal, uint64_t seed, Work& work,
               std::span<trace::Ray> rays) {
  const size_t count = rays.size();
  sobol_owen_2d_points(seed, work.u, work.v);
  local_directions(work, count);
  std::array<uint32_t, kCells + 1> place{};
  for (size_t i = 0; i < count; ++i) ++place[work.cell[i] + 1];
  for (size_t c = 0; c < kCells; ++c) place[c + 1] += place[c];
  const Frame frame = frame_around(normal);
  const bool bent = !(normal == geometric_normal);
  for (size_t i = 0; i < count; ++i) {
    Vec3 d = frame.to_world({work.x[i], work.y[i], work.z[i]});
    if (bent) d = transport::mirrored_above(d, geometric_normal);
    const uint32_t at = place[work.cell[i]]++;
    rays[at] = {origin, 0, d, INFINITY};
    work.second_half[at] = 2 * i >= count;
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
};

/// Adds radiance that a ray has brought without the map.
void add_light(Rgb l, bool second_half, size_t element, TracedHits& out) {
  out.sky[element] += l;
  out.sky_luminance2[element] += luminance(l) * luminance(l);
  out.sky_first_less_second[element] += second_half ? -luminance(l) : luminance(l);
}

/// Counts what an element's rays met, and keeps the hits that bring light.
void sort_hits(const World& world, Work& work, size_t element, TracedHits& out, HitTile& tile) {
  for (size_t k = 0; k < work.hits.size(); ++k) {
    const trace::Hit& hit = work.hits[k];
    if (!hit.found()) {
      ++out.escaped[element];
      Rgb l = transport::soft_radiance(world.scene, world.around, work.rays[k].direction);
      if (!work.tint.empty()) l = l * work.tint[k];
      add_light(l, work.second_half[k], element, out);
      continue;
    }
    if (hit.back_face &&
        !scene::reflects_from_behind(scene::material_at(world.scene, hit.point()))) {
      ++out.met_back[element];
      continue;
    }
    if (hit.back_face) ++out.met_double_sided_back[element];
    if (world.near != nullptr) {
      NearPath path{uint32_t(k), work.tint.empty() ? Rgb{1, 1, 1} : work.tint[k], {}, hit, {}};
      if (goes_on(*world.near, path)) {
        work.near.paths.push_back(path);
        continue;
      }
    }
    const uint32_t tint =
        work.tint.empty() ? kNoTint : pack_tint(work.tint[k], hash64(element, k ^ 0x7147u));
    tile.entries.push_back(store(world.atlas, hit.point(), {tint, work.second_half[k] != 0}));
  }
}

/// Follows the rays of an element on that ended nearby. Returns the number of rays.
uint64_t follow_on(const World& world, Work& work, size_t element, uint64_t seed, TracedHits& out,
                   HitTile& tile) {
  return follow_near(*world.near, seed, work.near, [&](const NearPath& path) {
    const bool second_half = work.second_half[path.ray] != 0;
    Rgb light = path.light;
    const bool alive = max_component(path.throughput) > 0;
    if (alive && !path.hit.found())
      light +=
          path.throughput * transport::soft_radiance(world.scene, world.around, path.direction);
    add_light(light, second_half, element, out);
    if (!alive || !path.hit.found()) return;
    if (path.hit.back_face &&
        !scene::reflects_from_behind(scene::material_at(world.scene, path.hit.point())))
      return;
    const uint32_t tint = pack_tint(path.throughput, hash64(element, path.ray ^ 0x4e37u));
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
  Work work(rays.size());
  fill_rays(origin, normal, geometric_normal, seed, work, rays);
}

Result<TracedHits> trace_hits(const scene::Scene& scene, const atlas::Atlas& atlas,
                              const transport::Elements& elements,
                              const transport::Surroundings& around, const trace::RayTracer& tracer,
                              const TraceParams& params, Progress& progress) {
  LUXEL_CHECK(params.samples >= 1 && params.samples <= 65535);
  const size_t samples = size_t(params.samples);
  LUXEL_TRY(HitStore hit_store, HitStore::create(elements.size(), kTileElements, samples,
                                                 params.memory_limit_bytes, params.scratch_folder));
  TracedHits out{std::move(hit_store), params.samples, {}, {}, {}, {}, {}, {}, 0};
  out.escaped.resize(elements.size());
  out.met_back.resize(elements.size());
  out.met_double_sided_back.resize(elements.size());
  out.sky.resize(elements.size());
  out.sky_luminance2.resize(elements.size());
  out.sky_first_less_second.resize(elements.size());
  out.rays = uint64_t(elements.size()) * samples;
  const float diagonal_m = scene::world_bounds(scene).diagonal();
  std::optional<NearWorld> near;
  std::vector<float> widths;
  if (params.near_lights != nullptr) {
    widths = texel_widths_m(scene, atlas);
    near.emplace(NearWorld{scene, atlas, *params.near_lights, tracer, widths, diagonal_m});
  }
  const World world{scene, atlas, around, near ? &*near : nullptr};
  std::atomic<uint64_t> more_rays{0};
  const auto trace_element = [&](size_t i, Work& work, HitTile& tile) {
    const Vec3 origin =
        trace::offset_origin(elements.position[i], elements.geometric_normal[i], diagonal_m);
    fill_rays(origin, elements.normal[i], elements.geometric_normal[i],
              hash64(params.seed ^ 0x6a7e, i), work, work.rays);
    tracer.closest_hits(work.rays, work.hits);
    if (tracer.has_tints()) {
      work.tint.assign(samples, {1, 1, 1});
      tracer.tint(work.rays, work.hits, work.tint);
    }
    sort_hits(world, work, i, out, tile);
    if (!work.near.paths.empty())
      more_rays += follow_on(world, work, i, hash64(params.seed ^ 0x7ea4, i), out, tile);
    tile.end.push_back(uint32_t(tile.entries.size()));
  };

  constexpr uint64_t kRaysPerAdvance = 8192;
  progress.begin("trace rays", out.rays);
  std::mutex mutex;
  Status status;
  parallel_for(elements.size(), kTileElements, [&](size_t begin, size_t end) {
    Work work(samples);
    HitTile tile;
    tile.entries.reserve((end - begin) * samples);
    uint64_t untold = 0;
    for (size_t i = begin; i < end; ++i) {
      if (progress.cancelled()) return;
      trace_element(i, work, tile);
      // Not for every element: the counter is shared by all threads.
      untold += samples;
      if (untold < kRaysPerAdvance && i + 1 < end) continue;
      progress.advance(untold);
      untold = 0;
    }
    const Status put = out.store.put(begin / kTileElements, std::move(tile));
    if (!put) {
      const std::lock_guard lock(mutex);
      if (status) status = put;
      progress.request_cancel();
    }
  });
  if (!status) return tl::unexpected(status.error());
  if (progress.cancelled()) return fail(ErrorCode::cancelled, "stopped by the user");
  out.rays += more_rays;
  return out;
}

}  // namespace luxel::gather
