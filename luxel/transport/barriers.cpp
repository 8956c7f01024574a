#include "luxel/transport/barriers.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>

#include "luxel/base/share_out.h"
#include "luxel/scene/facet.h"
#include "luxel/scene/off_surface.h"
#include "luxel/transport/back_faces.h"
#include "luxel/transport/clear_runs.h"

namespace luxel::transport {
namespace {

/// Heights of lines, in steps: of that which a barrier blocks, and of ways over it.
constexpr float kLow = 0.5f;
/// Heights, in steps: of lines over what lies on a surface, such as a rug; and of where ways begin.
constexpr float kLowest = 0.05f, kFoot = 1e-3f;
constexpr std::array kOver{1.0f, 2.0f};
constexpr int kRaysForOpen = 32;
/// A way past a barrier is looked for so far around a texel, in texels.
constexpr int kWindow = 3;

/// The other texel of a pair.
struct Offset {
  int x, y;
  float steps() const { return std::hypot(float(x), float(y)); }
};
/// Neighbours; offset k + 4 is the opposite of offset k.
constexpr std::array<Offset, 8> kNeighbours{
    {{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}}};
constexpr size_t kHalf = 4;
/// Half of the next neighbours.
constexpr std::array<Offset, 8> kNext{
    {{2, 0}, {2, 1}, {2, 2}, {1, 2}, {0, 2}, {-1, 2}, {-2, 2}, {-2, 1}}};

trace::Ray line_above(const FlatPoint& a, const FlatPoint& b, float height_m) {
  const Vec3 from = a.position + a.normal * height_m, to = b.position + b.normal * height_m;
  return {from, 0, to - from, 1};
}

/// Openness of a texel, as far as it is known.
enum class Openness : uint8_t { not_asked, open, enclosed };

/// Work that goes over the texels.
struct Search {
  const scene::Scene& scene;
  const atlas::Atlas& atlas;
  const atlas::TexelMap& map;
  const trace::RayTracer& tracer;
  std::span<Openness> openness;  ///< per texel, as in_the_open() finds it

  uint32_t chart_of(uint32_t texel) const { return atlas.chart[map.texels[texel].triangle_number]; }
  FlatPoint place(uint32_t texel) const { return flat_point(scene, map.texels[texel].sample); }

  uint32_t neighbour(uint32_t texel, const Offset& o) const {
    const int x = int(map.texels[texel].x) + o.x, y = int(map.texels[texel].y) + o.y;
    const int side = map.resolution;
    if (x < 0 || y < 0 || x >= side || y >= side) return atlas::kNone;
    const uint32_t other = map.texel_at[size_t(y) * size_t(side) + size_t(x)];
    return other != atlas::kNone && chart_of(other) == chart_of(texel) ? other : atlas::kNone;
  }

  /// A texel is in many pairs: rays ask once. Threads that ask at a time find the same.
  bool in_the_open(uint32_t texel) const {
    const std::atomic_ref<Openness> known(openness[texel]);
    if (const Openness k = known.load(std::memory_order_relaxed); k != Openness::not_asked)
      return k == Openness::open;
    const FlatPoint p = place(texel);
    const bool open = !is_enclosed(scene, tracer, just_above(p), p.normal, kRaysForOpen);
    known.store(open ? Openness::open : Openness::enclosed, std::memory_order_relaxed);
    return open;
  }

  std::optional<Plane> barrier(uint32_t a, uint32_t b, const Offset& o) const {
    const FlatPoint p = place(a), q = place(b);
    return barrier_between(scene, atlas, tracer, chart_of(a), p, q,
                           length(q.position - p.position) / o.steps());
  }

  /// True: nothing is in the way of lines between the texels of a run and their neighbours on its
  /// triangle, at `height` steps. The texels' samples lie anywhere in them: a step between two may
  /// be three times that between their centres.
  bool has_clear_lines(TexelRun run, float height) const {
    const FlatPoint p = place(run.first);
    const float rounding_m = scene::rounding_m(p.position, p.size_m);
    return is_clear(scene, atlas, map, tracer, run, {-rounding_m, 3 * height, 0, false});
  }

  Result<std::vector<uint8_t>> open_ways(Team* team, Progress& progress) const;
  template <class IsOpen>
  void find_forward_ways(uint32_t begin, uint32_t end, float height, std::span<uint8_t> ways,
                         const IsOpen& is_open) const;
  bool is_way_past(uint32_t a, const Offset& to, std::span<const uint8_t> ways) const;
  std::vector<atlas::PartedPoints> parted(uint32_t begin, uint32_t end,
                                          std::span<const uint8_t> ways) const;
};

/// Sets the bits k < kHalf of texels [begin, end): the neighbour is there, and nothing is in the
/// way of the line at `height` steps, or is_open(texel, neighbour, step in m) says that it does not
/// part them.
template <class IsOpen>
void Search::find_forward_ways(uint32_t begin, uint32_t end, float height, std::span<uint8_t> ways,
                               const IsOpen& is_open) const {
  struct Pair {
    uint32_t a, b, offset;
    float step_m;
  };
  std::vector<trace::Ray> rays;
  std::vector<Pair> pairs;
  TexelRun run;
  bool clear = false;
  for (uint32_t i = begin; i < end; ++i) {
    if (i >= run.first + run.count) {
      run = run_from(map, i, end - i);
      clear = has_clear_lines(run, height);
    }
    std::optional<FlatPoint> a;
    for (uint32_t k = 0; k < kHalf; ++k) {
      const uint32_t j = neighbour(i, kNeighbours[k]);
      if (j == atlas::kNone) continue;
      if (clear && map.texels[j].triangle_number == map.texels[i].triangle_number) {
        ways[i] |= uint8_t(1u << k);
        continue;
      }
      if (!a) a = place(i);
      const FlatPoint b = place(j);
      const float step_m = length(b.position - a->position) / kNeighbours[k].steps();
      pairs.push_back({i, j, k, step_m}), rays.push_back(line_above(*a, b, height * step_m));
    }
  }
  std::vector<uint8_t> blocked(rays.size());
  tracer.occluded(rays, blocked);
  for (size_t n = 0; n < pairs.size(); ++n) {
    const auto& [i, j, k, step_m] = pairs[n];
    if (!blocked[n] || is_open(i, j, step_m)) ways[i] |= uint8_t(1u << k);
  }
}

/// Per texel a bit for each of kNeighbours: there is one, and no barrier between.
Result<std::vector<uint8_t>> Search::open_ways(Team* team, Progress& progress) const {
  constexpr size_t kBlock = 2048;
  std::vector<uint8_t> ways(map.texels.size());
  const auto find = [&](size_t begin, size_t end) {
    find_forward_ways(
        uint32_t(begin), uint32_t(end), kLow, ways, [&](uint32_t i, uint32_t j, float step_m) {
          return !barrier_between(scene, atlas, tracer, chart_of(i), place(i), place(j), step_m);
        });
    progress.advance(end - begin);
  };
  LUXEL_TRY_STATUS(share_ranges(team, ways.size(), kBlock, progress, find, std::span(ways)));
  for (uint32_t i = 0; i < ways.size(); ++i)
    for (size_t k = 0; k < kHalf; ++k)
      if (ways[i] >> k & 1) ways[neighbour(i, kNeighbours[k])] |= uint8_t(1u << (k + kHalf));
  return ways;
}

/// True where open ways lead from a texel to the one at `to` within the window: light comes around
/// the end of a barrier, or the corner of a box, as near as that.
bool Search::is_way_past(uint32_t a, const Offset& to, std::span<const uint8_t> ways) const {
  constexpr int kAcross = 2 * kWindow + 1;
  std::array<uint8_t, size_t(kAcross) * kAcross> seen{};
  std::array<std::pair<uint32_t, Offset>, size_t(kAcross) * kAcross> queue;
  const auto seen_at = [&](const Offset& o) -> uint8_t& {
    return seen[size_t(o.y + kWindow) * kAcross + size_t(o.x + kWindow)];
  };
  size_t first = 0, last = 0;
  queue[last++] = {a, {0, 0}}, seen_at({0, 0}) = 1;
  while (first < last) {
    const auto [texel, at] = queue[first++];
    if (at.x == to.x && at.y == to.y) return true;
    for (size_t k = 0; k < kNeighbours.size(); ++k) {
      const Offset next{at.x + kNeighbours[k].x, at.y + kNeighbours[k].y};
      if (!(ways[texel] >> k & 1) || std::abs(next.x) > kWindow || std::abs(next.y) > kWindow ||
          seen_at(next))
        continue;
      seen_at(next) = 1;
      queue[last++] = {neighbour(texel, kNeighbours[k]), next};
    }
  }
  return false;
}

std::vector<atlas::PartedPoints> Search::parted(uint32_t begin, uint32_t end,
                                                std::span<const uint8_t> ways) const {
  // Pairs between which there may be a barrier: something is in the lowest line's way.
  struct Pair {
    uint32_t a, b;
    Offset offset;
  };
  std::vector<Pair> pairs;
  std::vector<trace::Ray> rays;
  const auto add = [&](uint32_t i, const Offset& o) {
    const uint32_t j = neighbour(i, o);
    if (j == atlas::kNone) return;
    const FlatPoint a = place(i), b = place(j);
    pairs.push_back({i, j, o});
    rays.push_back(line_above(a, b, kLow * (length(b.position - a.position) / o.steps())));
  };
  for (uint32_t i = begin; i < end; ++i) {
    if (ways[i] == 0xff) continue;
    for (size_t k = 0; k < kHalf; ++k)
      if (!(ways[i] >> k & 1)) add(i, kNeighbours[k]);
    for (const Offset& o : kNext) add(i, o);
  }
  std::vector<uint8_t> blocked(rays.size());
  tracer.occluded(rays, blocked);
  // Those with a barrier and no way past it; most of them lie inside of solids.
  std::vector<atlas::PartedPoints> found;
  for (size_t n = 0; n < pairs.size(); ++n) {
    if (!blocked[n]) continue;
    const auto& [i, j, o] = pairs[n];
    if (is_way_past(i, o, ways) || !in_the_open(i) || !in_the_open(j)) continue;
    if (const auto plane = barrier(i, j, o))
      found.push_back({chart_of(i), place(i).position, place(j).position, *plane});
  }
  return found;
}

}  // namespace

FlatPoint flat_point(const scene::Scene& scene, const scene::SurfacePoint& p) {
  const scene::Facet facet = scene::facet_of(scene, p.instance, p.triangle);
  const scene::Triangle3& t = facet.corners;
  return {interpolate(t.a, t.b, t.c, p.at), facet.front, facet.size_m};
}

Vec3 just_above(const FlatPoint& p) { return scene::off_surface(p.position, p.normal, p.size_m); }

bool is_barrier(const scene::Scene& scene, const atlas::Atlas& atlas, uint32_t chart,
                const trace::Hit& hit) {
  if (!hit.found()) return false;
  if (atlas.chart[atlas.triangle_number(hit.instance, hit.triangle)] == chart) return false;
  const scene::Material& material = scene::material_at(scene, hit.point());
  return material.alpha_mode == scene::AlphaMode::mask || !scene::lets_light_through(material);
}

std::optional<Plane> barrier_between(const scene::Scene& scene, const atlas::Atlas& atlas,
                                     const trace::RayTracer& tracer, uint32_t chart,
                                     const FlatPoint& a, const FlatPoint& b, float step_m) {
  const auto above = [&](const FlatPoint& p, float height) {
    return p.position + p.normal * (height * step_m);
  };
  const auto met = [&](Vec3 from, Vec3 to) { return tracer.closest_hit({from, 0, to - from, 1}); };
  const auto is_free = [&](Vec3 from, Vec3 to) {
    return !is_barrier(scene, atlas, chart, met(from, to));
  };
  const Vec3 low_a = above(a, kLow), low_b = above(b, kLow);
  const trace::Hit lowest = met(low_a, low_b);
  if (!is_barrier(scene, atlas, chart, lowest)) return {};
  for (const float height : kOver) {
    const Vec3 high_a = above(a, height), high_b = above(b, height);
    if (is_free(high_a, high_b) && is_free(low_a, high_a) && is_free(low_b, high_b)) return {};
  }
  const DVec3 normal = to_double(scene::front_normal(scene, lowest.instance, lowest.triangle));
  return Plane{normal, dot(normal, to_double(scene::world_position(scene, lowest.point())))};
}

Result<std::vector<atlas::PartedPoints>> find_parted(const scene::Scene& scene,
                                                     const atlas::Atlas& atlas,
                                                     const atlas::TexelMap& map,
                                                     const trace::RayTracer& tracer,
                                                     Progress& progress, Team* team) {
  constexpr size_t kBlock = 256;
  progress.begin("walls", 2 * map.texels.size());
  std::vector<Openness> openness(map.texels.size());
  const Search search{scene, atlas, map, tracer, openness};
  LUXEL_TRY(const std::vector<uint8_t> ways, search.open_ways(team, progress));
  return share_lists<atlas::PartedPoints>(
      team, ways.size(), kBlock, progress, [&](size_t begin, size_t end) {
        progress.advance(end - begin);
        return search.parted(uint32_t(begin), uint32_t(end), ways);
      });
}

bool is_open_between(const scene::Scene& scene, const atlas::Atlas& atlas,
                     const trace::RayTracer& tracer, const ChartPoint& a, const ChartPoint& b,
                     float step_m) {
  const auto above = [&](const ChartPoint& p, float height) {
    return p.at.position + p.at.normal * (height * step_m);
  };
  const auto is_free = [&](Vec3 from, Vec3 to) {
    const trace::Hit hit = tracer.closest_hit({from, 0, to - from, 1});
    return !is_barrier(scene, atlas, a.chart, hit) || !is_barrier(scene, atlas, b.chart, hit);
  };
  const Vec3 from = above(a, kFoot), to = above(b, kFoot);
  for (const float height : {kLowest, kLow, kOver[0], kOver[1]}) {
    const Vec3 high_a = above(a, height), high_b = above(b, height);
    if (is_free(high_a, high_b) && is_free(from, high_a) && is_free(to, high_b)) return true;
  }
  return false;
}

Status for_open_neighbours(const scene::Scene& scene, const atlas::Atlas& atlas,
                           const atlas::TexelMap& map, const trace::RayTracer& tracer,
                           const std::function<void(uint32_t, uint32_t)>& visit, Progress& progress,
                           Team* team) {
  constexpr size_t kBlock = 2048;
  progress.begin("neighbours", map.texels.size());
  const Search search{scene, atlas, map, tracer, {}};
  std::vector<uint8_t> ways(map.texels.size());
  const auto find = [&](size_t begin, size_t end) {
    search.find_forward_ways(
        uint32_t(begin), uint32_t(end), kFoot, ways, [&](uint32_t i, uint32_t j, float step_m) {
          const uint32_t chart = search.chart_of(i);
          return is_open_between(scene, atlas, tracer, {search.place(i), chart},
                                 {search.place(j), chart}, step_m);
        });
    progress.advance(end - begin);
  };
  LUXEL_TRY_STATUS(share_ranges(team, ways.size(), kBlock, progress, find, std::span(ways)));
  for (uint32_t i = 0; i < ways.size(); ++i)
    for (size_t k = 0; k < kHalf; ++k)
      if (ways[i] >> k & 1) visit(i, search.neighbour(i, kNeighbours[k]));
  return {};
}

}  // namespace luxel::transport
