#include "luxel/transport/barriers.h"

#include <algorithm>
#include <array>

#include "luxel/base/parallel.h"
#include "luxel/transport/back_faces.h"

namespace luxel::transport {
namespace {

constexpr std::array kHeights{0.5f, 1.0f, 2.0f};  ///< of the lines, in steps
constexpr int kRaysForOpen = 32;

/// The other texel of a pair.
struct Offset {
  uint32_t x, y;
  float steps;
};
constexpr std::array<Offset, 4> kOffsets{{{1, 0, 1}, {2, 0, 2}, {0, 1, 1}, {0, 2, 2}}};

trace::Ray line_above(const FlatPoint& a, const FlatPoint& b, float height_m) {
  const Vec3 from = a.position + a.normal * height_m, to = b.position + b.normal * height_m;
  return {from, 0, to - from, 1};
}

bool is_barrier(const scene::Scene& scene, const atlas::Atlas& atlas, uint32_t chart,
                const trace::Hit& hit) {
  if (!hit.found()) return false;
  if (atlas.chart[atlas.triangle_number(hit.instance, hit.triangle)] == chart) return false;
  const scene::Material& material = scene::material_at(scene, hit.point());
  return material.alpha_mode == scene::AlphaMode::mask || !scene::lets_light_through(material);
}

struct Pair {
  uint32_t a, b;
  float step_m;
};

/// Work that goes over the texels once.
struct Search {
  const scene::Scene& scene;
  const atlas::Atlas& atlas;
  const atlas::TexelMap& map;
  const trace::RayTracer& tracer;
  float diagonal_m;

  uint32_t chart_of(uint32_t texel) const { return atlas.chart[map.texels[texel].triangle_number]; }
  FlatPoint place(uint32_t texel) const { return flat_point(scene, map.texels[texel].sample); }

  uint32_t neighbour(uint32_t texel, const Offset& o) const {
    const uint32_t x = map.texels[texel].x + o.x, y = map.texels[texel].y + o.y;
    const auto side = uint32_t(map.resolution);
    if (x >= side || y >= side) return atlas::kNone;
    const uint32_t other = map.texel_at[size_t(y) * side + x];
    return other != atlas::kNone && chart_of(other) == chart_of(texel) ? other : atlas::kNone;
  }

  bool in_the_open(uint32_t texel) const {
    const FlatPoint p = place(texel);
    const Vec3 from = trace::offset_origin(p.position, p.normal, diagonal_m);
    return !is_enclosed(scene, tracer, from, p.normal, kRaysForOpen, diagonal_m);
  }

  /// The pairs of texels [begin, end) whose lowest line is blocked by anything.
  std::vector<Pair> blocked_pairs(uint32_t begin, uint32_t end) const {
    std::vector<Pair> pairs;
    std::vector<trace::Ray> rays;
    for (uint32_t i = begin; i < end; ++i) {
      const FlatPoint a = place(i);
      for (const Offset& o : kOffsets) {
        const uint32_t j = neighbour(i, o);
        if (j == atlas::kNone) continue;
        const FlatPoint b = place(j);
        const float step_m = length(b.position - a.position) / o.steps;
        pairs.push_back({i, j, step_m});
        rays.push_back(line_above(a, b, kHeights[0] * step_m));
      }
    }
    std::vector<uint8_t> blocked(rays.size());
    tracer.occluded(rays, blocked);
    size_t kept = 0;
    for (size_t k = 0; k < pairs.size(); ++k)
      if (blocked[k]) pairs[kept++] = pairs[k];
    pairs.resize(kept);
    return pairs;
  }

  std::vector<atlas::PartedPoints> parted(uint32_t begin, uint32_t end) const {
    std::vector<atlas::PartedPoints> found;
    for (const Pair& pair : blocked_pairs(begin, end)) {
      const uint32_t chart = chart_of(pair.a);
      const FlatPoint a = place(pair.a), b = place(pair.b);
      const auto plane = barrier_between(scene, atlas, tracer, chart, a, b, pair.step_m);
      if (!plane || !in_the_open(pair.a) || !in_the_open(pair.b)) continue;
      found.push_back({chart, a.position, b.position, *plane});
    }
    return found;
  }
};

}  // namespace

FlatPoint flat_point(const scene::Scene& scene, const scene::SurfacePoint& p) {
  return {scene::world_position(scene, p), scene::front_normal(scene, p.instance, p.triangle)};
}

std::optional<Plane> barrier_between(const scene::Scene& scene, const atlas::Atlas& atlas,
                                     const trace::RayTracer& tracer, uint32_t chart,
                                     const FlatPoint& a, const FlatPoint& b, float step_m) {
  std::optional<Plane> lowest;
  for (const float height : kHeights) {
    const trace::Hit hit = tracer.closest_hit(line_above(a, b, height * step_m));
    if (!is_barrier(scene, atlas, chart, hit)) return {};
    if (lowest) continue;
    const DVec3 normal = to_double(scene::front_normal(scene, hit.instance, hit.triangle));
    lowest = Plane{normal, dot(normal, to_double(scene::world_position(scene, hit.point())))};
  }
  return lowest;
}

std::vector<atlas::PartedPoints> find_parted(const scene::Scene& scene, const atlas::Atlas& atlas,
                                             const atlas::TexelMap& map,
                                             const trace::RayTracer& tracer) {
  constexpr size_t kBlock = 2048;
  const Search search{scene, atlas, map, tracer, scene::world_bounds(scene).diagonal()};
  const size_t count = map.texels.size();
  std::vector<std::vector<atlas::PartedPoints>> found((count + kBlock - 1) / kBlock);
  parallel_for(count, kBlock, [&](size_t begin, size_t end) {
    found[begin / kBlock] = search.parted(uint32_t(begin), uint32_t(end));
  });
  std::vector<atlas::PartedPoints> all;
  for (const auto& block : found) all.insert(all.end(), block.begin(), block.end());
  return all;
}

}  // namespace luxel::transport
