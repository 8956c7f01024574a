#include "solve/gather/trace_hits.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <mutex>

#include "base/check.h"
#include "base/parallel.h"
#include "base/random.h"
#include "base/warp.h"

namespace luxel::gather {
namespace {

/// Directions are sorted by cells of the unit square, 16 x 16 in Morton order.
constexpr uint32_t kCellsLog2 = 4;
constexpr size_t kCells = size_t(1) << (2 * kCellsLog2);

uint32_t morton_cell(Vec2 u) {
  const auto spread = [](uint32_t x) {
    x = (x | (x << 2)) & 0x33;
    return (x | (x << 1)) & 0x55;
  };
  const float scale = float(1u << kCellsLog2);
  return spread(uint32_t(u.x * scale)) | (spread(uint32_t(u.y * scale)) << 1);
}

/// Sobol points in the order of their cells (a counting sort). Buffers are the caller's.
void sorted_points(uint64_t seed, size_t count, std::vector<Vec2>& points,
                   std::vector<Vec2>& scratch) {
  points.resize(count), scratch.resize(count);
  std::array<uint32_t, kCells + 1> first{};
  for (size_t i = 0; i < count; ++i) {
    scratch[i] = sobol_owen_2d(uint32_t(i), seed);
    ++first[morton_cell(scratch[i]) + 1];
  }
  for (size_t c = 0; c < kCells; ++c) first[c + 1] += first[c];
  for (size_t i = 0; i < count; ++i) points[first[morton_cell(scratch[i])]++] = scratch[i];
}

/// cos and sin of 2 pi x for x in [0, 1), to 1e-7: a quarter turn by Taylor's series about its
/// middle. The compiler turns the loop that calls it into vector code, which std::sin prevents.
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

/// Everything a worker needs, reused from element to element.
struct Work {
  std::vector<Vec2> points, scratch;
  std::vector<trace::Ray> rays;
  std::vector<trace::Hit> hits;
};

void fill_rays(Vec3 origin, Vec3 normal, Vec3 geometric_normal, uint64_t seed, Work& work,
               std::span<trace::Ray> rays) {
  sorted_points(seed, rays.size(), work.points, work.scratch);
  const Frame frame = frame_around(normal);
  for (size_t k = 0; k < rays.size(); ++k) {
    const Vec2 u = work.points[k];
    const Vec2 circle = unit_circle(u.x);
    const float r = std::sqrt(u.y);
    Vec3 d = frame.to_world({circle.x * r, circle.y * r, std::sqrt(std::max(0.0f, 1 - u.y))});
    const float above = dot(d, geometric_normal);
    if (above < 0) d += geometric_normal * (-2 * above);
    rays[k] = {origin, 0, d, INFINITY};
  }
}

StoredHit store(const atlas::Atlas& atlas, const trace::Hit& hit) {
  const auto& corners = atlas.corners[atlas.triangle_number(hit.instance, hit.triangle)];
  const Vec2 at = interpolate(corners[0], corners[1], corners[2], hit.at);
  const float limit = float(atlas.resolution);
  const float x = std::clamp(at.x, 0.0f, limit) + 0.5f, y = std::clamp(at.y, 0.0f, limit) + 0.5f;
  const uint32_t x0 = uint32_t(x), y0 = uint32_t(y);  // with the border of one texel
  return {y0 * uint32_t(atlas.resolution + 2) + x0, uint16_t((x - float(x0)) * 65535.0f + 0.5f),
          uint16_t((y - float(y0)) * 65535.0f + 0.5f)};
}

/// Which materials are one-sided, by (mesh, triangle): asked for every hit.
bool brings_light(const scene::Scene& scene, const trace::Hit& hit) {
  return !hit.back_face || scene::material_at(scene, hit.point()).double_sided;
}

}  // namespace

void element_rays(Vec3 origin, Vec3 normal, Vec3 geometric_normal, uint64_t seed,
                  std::span<trace::Ray> rays) {
  Work work;
  fill_rays(origin, normal, geometric_normal, seed, work, rays);
}

Result<TracedHits> trace_hits(const scene::Scene& scene, const atlas::Atlas& atlas,
                              const transport::Elements& elements, const trace::RayTracer& tracer,
                              const TraceParams& params, Progress& progress) {
  LUXEL_CHECK(params.samples >= 1 && params.samples <= 65535);
  const size_t samples = size_t(params.samples);
  LUXEL_TRY(HitStore hit_store, HitStore::create(elements.size(), samples,
                                                 params.memory_limit_bytes, params.scratch_folder));
  TracedHits out{std::move(hit_store), params.samples, {}, {}, 0};
  out.escaped.resize(elements.size());
  out.met_back.resize(elements.size());
  out.rays = uint64_t(elements.size()) * samples;
  const float diagonal_m = scene::world_bounds(scene).diagonal();
  const auto trace_element = [&](size_t i, Work& work, HitTile& tile) {
    const Vec3 origin =
        trace::offset_origin(elements.position[i], elements.geometric_normal[i], diagonal_m);
    fill_rays(origin, elements.normal[i], elements.geometric_normal[i],
              hash64(params.seed ^ 0x6a7e, i), work, work.rays);
    tracer.closest_hits(work.rays, work.hits);
    for (const trace::Hit& hit : work.hits) {
      if (!hit.found())
        ++out.escaped[i];
      else if (!brings_light(scene, hit))
        ++out.met_back[i];
      else
        tile.hits.push_back(store(atlas, hit));
    }
    tile.end.push_back(uint32_t(tile.hits.size()));
  };

  progress.begin("trace rays", out.rays);
  std::mutex mutex;
  Status status;
  parallel_for(elements.size(), kTileElements, [&](size_t begin, size_t end) {
    Work work;
    work.rays.resize(samples), work.hits.resize(samples);
    HitTile tile;
    tile.hits.reserve((end - begin) * samples);
    for (size_t i = begin; i < end; ++i) {
      if (progress.cancelled()) return;
      trace_element(i, work, tile);
      progress.advance(samples);
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
  return out;
}

}  // namespace luxel::gather
