#include "luxel/transport/own_side.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>

#include "luxel/atlas/cover.h"
#include "luxel/atlas/footprint.h"
#include "luxel/base/parallel.h"
#include "luxel/scene/drawn_triangle.h"
#include "luxel/transport/back_faces.h"
#include "luxel/transport/barriers.h"
#include "luxel/transport/texel_width.h"

namespace luxel::transport {
namespace {

/// The height of a line's end above the surface, in texels: above what lies on it, such as a rug;
/// and beside a wall that leans over it, inside of which the line would begin.
constexpr float kLineHeight = 0.05f, kLowHeight = 1e-3f;
/// Texels of other charts that lie farther away than so many texels are no neighbours in space.
constexpr float kFarTexels = 3;
/// Texels around the four of a look-up that are asked, on each side.
constexpr int kAround = 1;
/// How far from a look-up's texels what decides about it lies, at most.
constexpr float kReachTexels = 4;
constexpr int kRaysForInside = 32;

/// A place and its chart.
struct Spot {
  FlatPoint at;
  uint32_t chart = 0;
  float width_m = 0;                ///< of a texel there
  float line_height = kLineHeight;  ///< in texels
};

Vec3 line_end(const Spot& s, float height) {
  return s.at.position + s.at.normal * (height * s.width_m);
}
trace::Ray line_between(const Spot& a, const Spot& b) {
  const Vec3 from = line_end(a, a.line_height);
  return {from, 0, line_end(b, b.line_height) - from, 1};
}
/// What leans over a place is in its way.
trace::Ray line_up(const Spot& s) {
  const Vec3 from = line_end(s, kLowHeight);
  return {from, 0, line_end(s, kLineHeight) - from, 1};
}

/// A spot over which nothing leans, for all that is known.
Spot plain_spot(const scene::Scene& scene, const atlas::Atlas& atlas,
                const scene::SurfacePoint& p) {
  return {flat_point(scene, p), atlas.chart[atlas.triangle_number(p.instance, p.triangle)],
          texel_width_m(scene, atlas, p.instance, p.triangle)};
}
Spot spot_at(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::RayTracer& tracer,
             const scene::SurfacePoint& p) {
  Spot out = plain_spot(scene, atlas, p);
  if (tracer.closest_hit(line_up(out)).found()) out.line_height = kLowHeight;
  return out;
}

bool is_far(const Spot& a, const Spot& b) {
  return a.chart != b.chart &&
         length(b.at.position - a.at.position) > kFarTexels * std::max(a.width_m, b.width_m);
}

/// Whether what a line from a to b has met stands between them.
bool is_between(const scene::Scene& scene, const atlas::Atlas& atlas, const Spot& a, const Spot& b,
                const trace::Hit& hit) {
  return is_barrier(scene, atlas, a.chart, hit) && is_barrier(scene, atlas, b.chart, hit);
}

bool sees(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::RayTracer& tracer,
          const Spot& a, const Spot& b) {
  return !is_far(a, b) && !is_between(scene, atlas, a, b, tracer.closest_hit(line_between(a, b)));
}

/// Neighbours on the map.
struct Neighbours {
  uint32_t a, b;
  std::array<int, 2> offset;  ///< of b from a
};

/// Per texel, 1 where a wall parts it from a neighbour or parts the texel itself; and where
/// anything hides it from a neighbour.
struct Walls {
  std::vector<uint8_t> parted, beside;
};

/// What is known of a texel's sample.
enum class Inside : uint8_t { not_asked, no, yes };

struct Texels {
  const OwnSides& in;
  float diagonal_m;
  std::span<Inside> inside{};  ///< per texel, as is_inside_solid() finds it; not for look-ups

  Spot spot(uint32_t texel) const {
    Spot out = plain_spot(in.scene, in.atlas, in.map.texels[texel].sample);
    if (in.is_under(texel)) out.line_height = kLowHeight;
    return out;
  }
  uint32_t at(int x, int y) const {
    const int side = in.map.resolution;
    if (x < 0 || y < 0 || x >= side || y >= side) return atlas::kNone;
    return in.map.texel_at[size_t(y) * size_t(side) + size_t(x)];
  }
  uint32_t beside(uint32_t texel, int dx, int dy) const {
    return at(int(in.map.texels[texel].x) + dx, int(in.map.texels[texel].y) + dy);
  }
  bool sees(const Spot& a, const Spot& b) const {
    return transport::sees(in.scene, in.atlas, in.tracer, a, b);
  }
  /// Whether light at a spot is never read, since it lies inside a solid for sure: more than half
  /// of what it sees would do.
  bool is_inside_solid(const Spot& s) const {
    const Vec3 from = trace::offset_origin(s.at.position, s.at.normal, diagonal_m);
    const BackFaces seen = count_back_faces(in.scene, in.tracer, from, s.at.normal, kRaysForInside);
    return 4 * seen.one_sided > 3 * seen.rays || 100 * all_backs(seen) >= 98 * seen.rays;
  }
  /// The answer for a texel's sample, for which rays are traced once: a texel is in many pairs.
  /// Threads that ask at a time find the same.
  bool is_inside_solid(uint32_t texel) const {
    const std::atomic_ref<Inside> known(inside[texel]);
    if (const Inside k = known.load(std::memory_order_relaxed); k != Inside::not_asked)
      return k == Inside::yes;
    const bool yes = is_inside_solid(spot(texel));
    known.store(yes ? Inside::yes : Inside::no, std::memory_order_relaxed);
    return yes;
  }

  bool is_at_border(uint32_t texel) const;
  bool parts(const Neighbours& pair) const;
  bool is_parted_within(uint32_t texel, std::span<const uint32_t> cover) const;
  std::vector<Neighbours> blocked(uint32_t begin, uint32_t end) const;
  std::vector<Neighbours> blocked() const;
  Walls find_walls() const;
};

/// Whether a wall stands between two neighbours that do not see each other. Around the corner of a
/// box, diagonal ones are seen by the texel between them.
bool Texels::parts(const Neighbours& pair) const {
  if (is_inside_solid(pair.a) || is_inside_solid(pair.b)) return false;
  const auto [dx, dy] = pair.offset;
  if (dx == 0 || dy == 0) return true;
  const Spot own = spot(pair.a), there = spot(pair.b);
  for (const uint32_t between : {beside(pair.a, dx, 0), beside(pair.a, 0, dy)}) {
    if (between == atlas::kNone) continue;
    const Spot elbow = spot(between);
    if (sees(own, elbow) && sees(elbow, there)) return false;
  }
  return true;
}

/// The corners of the part of a triangle that lies in a texel, in texels.
std::vector<Vec2> part_in_texel(const std::array<Vec2, 3>& corners, const atlas::Texel& texel) {
  const atlas::UvTriangle triangle =
      atlas::uv_triangle({to_double(corners[0]), to_double(corners[1]), to_double(corners[2])});
  if (triangle.area2 == 0) return {};
  const auto [corner, count] = atlas::clipped_corners(triangle, int(texel.x), int(texel.y));
  std::vector<Vec2> out;
  for (size_t k = 0; k < count; ++k)
    out.push_back({float(texel.x + corner[k].x), float(texel.y + corner[k].y)});
  return out;
}

/// Whether a wall stands between a texel's sample and some of the outline of what `cover`, the
/// triangles that cover it, have in the texel.
bool Texels::is_parted_within(uint32_t texel, std::span<const uint32_t> cover) const {
  constexpr size_t kMostTriangles = 16;
  constexpr float kInwards = 0.02f;
  const atlas::Texel& t = in.map.texels[texel];
  const Spot own = spot(texel);
  for (const uint32_t number : cover.first(std::min(cover.size(), kMostTriangles))) {
    const auto& corners = in.atlas.corners[number];
    const auto drawn = scene::drawn_triangle(in.atlas.first_triangle, number);
    const std::vector<Vec2> part = part_in_texel(corners, t);
    Vec2 middle{0, 0};
    for (const Vec2& p : part) middle = middle + p * (1 / float(part.size()));
    const auto is_hidden = [&](Vec2 p) {
      const Barycentric at = atlas::barycentric_in(corners, p + (middle - p) * kInwards);
      if (at.u < 0 || at.v < 0 || at.u + at.v > 1) return false;  // it has no area
      const Spot there =
          spot_at(in.scene, in.atlas, in.tracer, {drawn.instance, drawn.triangle, at});
      return !sees(own, there) && !is_inside_solid(texel) && !is_inside_solid(there);
    };
    for (size_t k = 0; k < part.size(); ++k) {
      const Vec2 next = part[(k + 1) % part.size()];
      if (is_hidden(part[k]) || is_hidden((part[k] + next) * 0.5f)) return true;
    }
  }
  return false;
}

/// The pairs of texels [begin, end) with neighbours that do not see each other.
std::vector<Neighbours> Texels::blocked(uint32_t begin, uint32_t end) const {
  constexpr std::array<std::array<int, 2>, 4> kForward{{{1, 0}, {0, 1}, {1, 1}, {-1, 1}}};
  std::vector<Neighbours> pairs;
  std::vector<std::array<Spot, 2>> spots;
  std::vector<trace::Ray> rays;
  for (uint32_t i = begin; i < end; ++i) {
    const Spot own = spot(i);
    for (const auto& offset : kForward) {
      const uint32_t j = beside(i, offset[0], offset[1]);
      if (j == atlas::kNone) continue;
      pairs.push_back({i, j, offset}), spots.push_back({own, spot(j)});
      rays.push_back(line_between(own, spots.back()[1]));
    }
  }
  std::vector<trace::Hit> hits(rays.size());
  in.tracer.closest_hits(rays, hits);
  size_t kept = 0;
  for (size_t k = 0; k < pairs.size(); ++k)
    if (is_far(spots[k][0], spots[k][1]) ||
        is_between(in.scene, in.atlas, spots[k][0], spots[k][1], hits[k]))
      pairs[kept++] = pairs[k];
  pairs.resize(kept);
  return pairs;
}

std::vector<Neighbours> Texels::blocked() const {
  constexpr size_t kBlock = 1024;
  const size_t count = in.map.texels.size();
  std::vector<std::vector<Neighbours>> found((count + kBlock - 1) / kBlock);
  parallel_for(count, kBlock, [&](size_t begin, size_t end) {
    found[begin / kBlock] = blocked(uint32_t(begin), uint32_t(end));
  });
  std::vector<Neighbours> all;
  for (const auto& block : found) all.insert(all.end(), block.begin(), block.end());
  return all;
}

bool Texels::is_at_border(uint32_t texel) const {
  for (int k = 0; k < 9; ++k)
    if (beside(texel, k % 3 - 1, k / 3 - 1) == atlas::kNone) return true;
  return false;
}

Walls Texels::find_walls() const {
  const size_t count = in.map.texels.size();
  const std::vector<Neighbours> pairs = blocked();
  std::vector<uint8_t> is_parted(pairs.size());
  Walls out{std::vector<uint8_t>(count), std::vector<uint8_t>(count)};
  parallel_for(pairs.size(), 16, [&](size_t begin, size_t end) {
    for (size_t k = begin; k < end; ++k) is_parted[k] = parts(pairs[k]);
  });
  for (size_t k = 0; k < pairs.size(); ++k) {
    out.beside[pairs[k].a] = out.beside[pairs[k].b] = 1;
    if (is_parted[k]) out.parted[pairs[k].a] = out.parted[pairs[k].b] = 1;
  }
  // A sliver beyond a wall has no sample of its own where a chart ends there, or where the wall
  // hides the next one.
  std::vector<uint32_t> which;
  for (uint32_t i = 0; i < count; ++i)
    if (!out.parted[i] && (out.beside[i] || is_at_border(i))) which.push_back(i);
  const atlas::Cover cover = atlas::cover_of(in.atlas, in.map, which);
  parallel_for(which.size(), 64, [&](size_t begin, size_t end) {
    for (size_t k = begin; k < end; ++k)
      out.parted[which[k]] = is_parted_within(which[k], cover.of(k));
  });
  return out;
}

/// Per texel a bit: something leans over its sample.
std::vector<uint64_t> find_under(const OwnSides& in) {
  constexpr size_t kBlock = 1024;  // whole words
  const size_t count = in.map.texels.size();
  std::vector<uint64_t> out((count + 63) / 64);
  parallel_for(count, kBlock, [&](size_t begin, size_t end) {
    std::vector<trace::Ray> rays;
    for (size_t i = begin; i < end; ++i)
      rays.push_back(line_up(plain_spot(in.scene, in.atlas, in.map.texels[i].sample)));
    std::vector<uint8_t> blocked(rays.size());
    in.tracer.occluded(rays, blocked);
    for (size_t i = begin; i < end; ++i)
      if (blocked[i - begin]) out[i / 64] |= uint64_t(1) << (i % 64);
  });
  return out;
}

uint32_t border_side(const atlas::TexelMap& map) { return uint32_t(map.resolution) + 2; }

/// The place's four texels: those to the right have bit 0, those below bit 1.
struct Four {
  std::array<uint32_t, 4> texel{};
  std::array<bool, 4> is_own{};
};

/// The weight with which the own ones of the four are read; 0 where others are read, too.
float weight_of(const Four& four, float fx, float fy) {
  float sum = 0;
  for (size_t k = 0; k < 4; ++k) {
    const float w = (k & 1 ? fx : 1 - fx) * (k & 2 ? fy : 1 - fy);
    if (w <= 0 || four.texel[k] == atlas::kNone) continue;
    if (!four.is_own[k]) return 0;
    sum += w;
  }
  return sum;
}

/// The place nearest to `p` that reads own texels alone; kReadsNothing: none of the four is.
LookupPlace nearest_own(const LookupPlace& p, const Four& four) {
  const auto distance = [&](float fx, float fy) { return std::hypot(fx - p.fx, fy - p.fy); };
  LookupPlace best = kReadsNothing;
  float nearest = INFINITY;
  for (const float fx : {p.fx, 0.0f, 1.0f})
    for (const float fy : {p.fy, 0.0f, 1.0f})
      if (weight_of(four, fx, fy) > 0 && distance(fx, fy) < nearest)
        nearest = distance(fx, fy), best = {p.base, fx, fy};
  return best;
}

/// The four look-ups around each marked texel that read it, as bits.
std::vector<uint64_t> blocks_of(const atlas::TexelMap& map, std::span<const uint8_t> marked) {
  const uint32_t side = border_side(map);
  std::vector<uint64_t> out((size_t(side) * side + 63) / 64);
  for (size_t i = 0; i < marked.size(); ++i) {
    if (!marked[i]) continue;
    const uint32_t last = (map.texels[i].y + 1u) * side + map.texels[i].x + 1u;
    for (const uint32_t base : {last, last - 1, last - side, last - side - 1})
      out[base / 64] |= uint64_t(1) << (base % 64);
  }
  return out;
}

}  // namespace

LookupPlace lookup_place(const atlas::Atlas& atlas, const scene::SurfacePoint& p) {
  const auto& corners = atlas.corners[atlas.triangle_number(p.instance, p.triangle)];
  const Vec2 at = interpolate(corners[0], corners[1], corners[2], p.at);
  const float limit = float(atlas.resolution);
  const float x = std::clamp(at.x, 0.0f, limit) + 0.5f, y = std::clamp(at.y, 0.0f, limit) + 0.5f;
  const uint32_t x0 = uint32_t(x), y0 = uint32_t(y);  // with the border of one texel
  return {y0 * uint32_t(atlas.resolution + 2) + x0, x - float(x0), y - float(y0)};
}

OwnSides find_own_sides(const scene::Scene& scene, const atlas::Atlas& atlas,
                        const atlas::TexelMap& map, const trace::RayTracer& tracer) {
  OwnSides out{scene, atlas, map, tracer};
  out.under = find_under(out);
  std::vector<Inside> inside(map.texels.size());
  const Walls walls = Texels{out, scene::world_bounds(scene).diagonal(), inside}.find_walls();
  out.mixed = blocks_of(map, walls.parted), out.beside_solids = blocks_of(map, walls.beside);
  return out;
}

LookupPlace own_lookup(const OwnSides& sides, const scene::SurfacePoint& p, MayBeInside inside) {
  const LookupPlace place = lookup_place(sides.atlas, p);
  const bool doubtful = inside == MayBeInside::yes && sides.is_beside_solids(place.base);
  if (!doubtful && !sides.is_mixed(place.base)) return place;
  const Texels texels{sides, 0};
  const Spot here = spot_at(sides.scene, sides.atlas, sides.tracer, p);
  const int side = int(border_side(sides.map));
  const int x0 = int(place.base) % side - 1, y0 = int(place.base) / side - 1;
  Four four;
  for (int k = 0; k < 4; ++k) {
    const uint32_t texel = texels.at(x0 + k % 2, y0 + k / 2);
    four.texel[size_t(k)] = texel;
    four.is_own[size_t(k)] = texel != atlas::kNone && texels.sees(here, texels.spot(texel));
  }
  const LookupPlace own = nearest_own(place, four);
  if (own.base != kReadsNothing.base) return own;
  // None of the four: the nearest of those around them.
  LookupPlace best = kReadsNothing;
  float nearest = INFINITY;
  for (int y = y0 - kAround; y <= y0 + 1 + kAround; ++y)
    for (int x = x0 - kAround; x <= x0 + 1 + kAround; ++x) {
      const uint32_t texel = texels.at(x, y);
      if (texel == atlas::kNone) continue;
      const float away = std::hypot(float(x - x0) - place.fx, float(y - y0) - place.fy);
      if (away >= nearest || !texels.sees(here, texels.spot(texel))) continue;
      nearest = away, best = {uint32_t((y + 1) * side + x + 1), 0, 0};
    }
  return best;
}

bool has_own_texel(const OwnSides& sides, const scene::SurfacePoint& p) {
  return !sides.is_mixed(lookup_place(sides.atlas, p).base) ||
         own_lookup(sides, p).base != kReadsNothing.base;
}

Rgb own_irradiance_at(const OwnSides& sides, std::span<const Rgb> irradiance,
                      const scene::SurfacePoint& p) {
  const LookupPlace place = own_lookup(sides, p);
  const Texels texels{sides, 0};
  const int side = int(border_side(sides.map));
  const int x0 = int(place.base) % side - 1, y0 = int(place.base) / side - 1;
  Rgb sum{};
  float weight = 0;
  for (int k = 0; k < 4; ++k) {
    const uint32_t texel = texels.at(x0 + k % 2, y0 + k / 2);
    const float w = (k & 1 ? place.fx : 1 - place.fx) * (k & 2 ? place.fy : 1 - place.fy);
    if (texel == atlas::kNone || w <= 0) continue;
    sum += irradiance[texel] * w, weight += w;
  }
  return weight > 0 ? sum / weight : Rgb{};
}

std::vector<uint64_t> lookups_near(const OwnSides& sides, std::span<const Box3> boxes) {
  std::vector<uint8_t> near(sides.map.texels.size());
  parallel_for(near.size(), 1024, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const scene::SurfacePoint& p = sides.map.texels[i].sample;
      const Vec3 at = scene::world_position(sides.scene, p);
      const float reach_m =
          kReachTexels * texel_width_m(sides.scene, sides.atlas, p.instance, p.triangle);
      near[i] = std::ranges::any_of(boxes, [&](const Box3& box) {
        return length(max(max(box.lower - at, at - box.upper), Vec3{})) <= reach_m;
      });
    }
  });
  std::vector<uint64_t> out = blocks_of(sides.map, near);
  out[0] |= 1;
  return out;
}

uint64_t find_on_side(const scene::Scene& scene, const atlas::Atlas& atlas,
                      const trace::RayTracer& tracer, const scene::SurfacePoint& sample,
                      std::span<const scene::SurfacePoint> points, std::span<uint8_t> on_side) {
  std::vector<Spot> spots;
  std::vector<trace::Ray> rays;
  const Spot own = spot_at(scene, atlas, tracer, sample);
  for (const scene::SurfacePoint& p : points) {
    spots.push_back(spot_at(scene, atlas, tracer, p));
    rays.push_back(line_between(own, spots.back()));
  }
  std::vector<trace::Hit> hits(rays.size());
  tracer.closest_hits(rays, hits);
  uint64_t traced = 2 * rays.size() + 1;
  for (size_t k = 0; k < points.size(); ++k)
    on_side[k] = !is_between(scene, atlas, own, spots[k], hits[k]);
  // Those that the sample does not see, around a corner, may be seen by others.
  const auto is_seen = [&](size_t k) {
    for (size_t j = 0; j < points.size(); ++j)
      if (on_side[j] && (++traced, sees(scene, atlas, tracer, spots[j], spots[k]))) return true;
    return false;
  };
  for (bool changes = true; changes;) {
    changes = false;
    for (size_t k = 0; k < points.size(); ++k)
      if (!on_side[k] && is_seen(k)) on_side[k] = 1, changes = true;
  }
  return traced;
}

}  // namespace luxel::transport
