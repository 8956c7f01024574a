// Where a map has texels of more than one side of a wall next to each other.
#include <algorithm>
#include <array>
#include <atomic>

#include "luxel/atlas/cover.h"
#include "luxel/atlas/footprint.h"
#include "luxel/base/share_out.h"
#include "luxel/scene/drawn_triangle.h"
#include "luxel/scene/off_surface.h"
#include "luxel/transport/back_faces.h"
#include "luxel/transport/clear_runs.h"
#include "luxel/transport/spots.h"

namespace luxel::transport {
namespace {

constexpr int kRaysForInside = 32;
/// Texels that a thread, or a member of a team, takes at a time.
constexpr size_t kTexelBlock = 1024;

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

/// Answer of is_inside_solid() for a texel's sample.
enum class Inside : uint8_t { not_asked, no, yes };

/// Places on the outlines of what some texels' charts have in them.
struct Outlines {
  std::vector<scene::SurfacePoint> places;
  std::vector<uint32_t> of;  ///< per place: the texel's number among those that are looked at
};

/// Where walls stand between texels and within them.
struct WallSearch : TexelSpots {
  std::span<Inside> inside{};  ///< per texel, as is_inside_solid() finds it

  /// True where a spot lies inside a solid for sure, so that its light is never read: backs of
  /// one-sided surfaces take more than three quarters of its view, and a half would do, or it sees
  /// nothing but backs.
  bool is_inside_solid(const Spot& s) const {
    const BackFaces seen =
        count_back_faces(in.scene, in.tracer, just_above(s.at), s.at.normal, kRaysForInside);
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
  void add_outline(uint32_t texel, uint32_t of, std::span<const uint32_t> cover,
                   Outlines& out) const;
  void find_parted_within(std::span<const uint32_t> texels, const Outlines& outlines,
                          std::span<uint8_t> parted) const;
  bool has_clear_lines(TexelRun run) const;
  std::vector<Neighbours> blocked(uint32_t begin, uint32_t end) const;
  Result<Walls> find_walls(Team* team, Progress& progress) const;
};

/// True where a wall stands between two neighbours that do not see each other. Around the corner of
/// a box none does: the texel between two diagonal ones sees both.
bool WallSearch::parts(const Neighbours& pair) const {
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

/// Adds the outline of what `cover`, the triangles that cover a texel, have in it, corners and
/// middles of sides; `of` tells which texel it is of.
void WallSearch::add_outline(uint32_t texel, uint32_t of, std::span<const uint32_t> cover,
                             Outlines& out) const {
  constexpr size_t kMostTriangles = 16;
  constexpr float kInwards = 0.02f;
  for (const uint32_t number : cover.first(std::min(cover.size(), kMostTriangles))) {
    const auto& corners = in.atlas.corners[number];
    const auto drawn = scene::drawn_triangle(in.atlas.first_triangle, number);
    const std::vector<Vec2> part = part_in_texel(corners, in.map.texels[texel]);
    Vec2 middle{0, 0};
    for (const Vec2& p : part) middle = middle + p * (1 / float(part.size()));
    const auto add = [&](Vec2 p) {
      const Barycentric at = atlas::barycentric_in(corners, p + (middle - p) * kInwards);
      if (at.u < 0 || at.v < 0 || at.u + at.v > 1) return;  // it has no area
      out.places.push_back({drawn.instance, drawn.triangle, at}), out.of.push_back(of);
    };
    for (size_t k = 0; k < part.size(); ++k)
      add(part[k]), add((part[k] + part[(k + 1) % part.size()]) * 0.5f);
  }
}

/// Sets parted[k] where a wall stands between the sample of texels[k] and some of its outline.
void WallSearch::find_parted_within(std::span<const uint32_t> texels, const Outlines& outlines,
                                    std::span<uint8_t> parted) const {
  SpotMaker maker = this->maker();
  std::vector<Spot> own;
  for (const uint32_t texel : texels) own.push_back(spot(texel, maker));
  const std::vector<Spot> there = spots_at(in.scene, in.atlas, in.tracer, outlines.places);
  std::vector<trace::Ray> rays;
  for (size_t k = 0; k < there.size(); ++k)
    rays.push_back(line_between(own[outlines.of[k]], there[k]));
  std::vector<trace::Hit> hits(rays.size());
  in.tracer.closest_hits(rays, hits);
  for (size_t k = 0; k < there.size(); ++k) {
    const uint32_t t = outlines.of[k];
    if (parted[t] ||
        (!is_far(own[t], there[k]) && !is_between(in.scene, in.atlas, own[t], there[k], hits[k])))
      continue;
    parted[t] = !is_inside_solid(texels[t]) && !is_inside_solid(there[k]);
  }
}

/// True: nothing is in the way of lines between the texels of a run and their neighbours on its
/// triangle.
bool WallSearch::has_clear_lines(TexelRun run) const {
  const FlatPoint p = flat_point(in.scene, in.map.texels[run.first].sample);
  const float rounding_m = scene::rounding_m(p.position, p.size_m);
  return is_clear(in.scene, in.atlas, in.map, in.tracer, run,
                  {-rounding_m, 1.01f * kLineHeight, 0, false});
}

/// The pairs of texels [begin, end) with neighbours that do not see each other.
std::vector<Neighbours> WallSearch::blocked(uint32_t begin, uint32_t end) const {
  constexpr std::array<std::array<int, 2>, 4> kForward{{{1, 0}, {0, 1}, {1, 1}, {-1, 1}}};
  std::vector<Neighbours> pairs;
  std::vector<std::array<Spot, 2>> spots;
  std::vector<trace::Ray> rays;
  SpotMaker own_maker = maker(), other_maker = maker();
  TexelRun run;
  bool clear = false;
  for (uint32_t i = begin; i < end; ++i) {
    if (i >= run.first + run.count) {
      run = run_from(in.map, i, end - i);
      clear = has_clear_lines(run);
    }
    for (const auto& offset : kForward) {
      const uint32_t j = beside(i, offset[0], offset[1]);
      if (j == atlas::kNone) continue;
      if (clear && in.map.texels[j].triangle_number == in.map.texels[i].triangle_number) continue;
      pairs.push_back({i, j, offset});
      spots.push_back({spot(i, own_maker), spot(j, other_maker)});
      rays.push_back(line_between(spots.back()[0], spots.back()[1]));
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

bool WallSearch::is_at_border(uint32_t texel) const {
  for (int k = 0; k < 9; ++k)
    if (beside(texel, k % 3 - 1, k / 3 - 1) == atlas::kNone) return true;
  return false;
}

Result<Walls> WallSearch::find_walls(Team* team, Progress& progress) const {
  const size_t count = in.map.texels.size();
  LUXEL_TRY(
      const std::vector<Neighbours> pairs,
      share_lists<Neighbours>(team, count, kTexelBlock, progress, [&](size_t begin, size_t end) {
        return blocked(uint32_t(begin), uint32_t(end));
      }));
  std::vector<uint8_t> is_parted(pairs.size());
  Walls out{std::vector<uint8_t>(count), std::vector<uint8_t>(count)};
  const auto find_parted = [&](size_t begin, size_t end) {
    for (size_t k = begin; k < end; ++k) is_parted[k] = parts(pairs[k]);
  };
  LUXEL_TRY_STATUS(
      share_ranges(team, pairs.size(), 16, progress, find_parted, std::span(is_parted)));
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
  std::vector<uint8_t> parted(which.size());
  const auto look_within = [&](size_t begin, size_t end) {
    Outlines outlines;
    for (size_t k = begin; k < end; ++k)
      add_outline(which[k], uint32_t(k - begin), cover.of(k), outlines);
    find_parted_within(std::span(which).subspan(begin, end - begin), outlines,
                       std::span(parted).subspan(begin, end - begin));
  };
  LUXEL_TRY_STATUS(share_ranges(team, which.size(), 64, progress, look_within, std::span(parted)));
  for (size_t k = 0; k < which.size(); ++k) out.parted[which[k]] = parted[k];
  return out;
}

/// Per texel a bit: something leans over its sample.
Result<std::vector<uint64_t>> find_under(const OwnSides& in, Team* team, Progress& progress) {
  constexpr size_t kWords = kTexelBlock / 64;
  const size_t count = in.map.texels.size();
  std::vector<uint64_t> out((count + 63) / 64);
  const auto find = [&](size_t first_word, size_t end_word) {
    const size_t begin = 64 * first_word, end = std::min(64 * end_word, count);
    SpotMaker maker{in.scene, in.atlas};
    std::vector<trace::Ray> rays;
    for (size_t i = begin; i < end; ++i)
      rays.push_back(line_up(maker.spot(in.map.texels[i].sample)));
    std::vector<uint8_t> blocked(rays.size());
    in.tracer.occluded(rays, blocked);
    for (size_t i = begin; i < end; ++i)
      if (blocked[i - begin]) out[i / 64] |= uint64_t(1) << (i % 64);
  };
  LUXEL_TRY_STATUS(share_ranges(team, out.size(), kWords, progress, find, std::span(out)));
  return out;
}

}  // namespace

Result<OwnSides> find_own_sides(const scene::Scene& scene, const atlas::Atlas& atlas,
                                const atlas::TexelMap& map, const trace::RayTracer& tracer,
                                Team* team, Progress& progress) {
  progress.begin("wall sides", 0);
  OwnSides out{scene, atlas, map, tracer};
  LUXEL_TRY(out.under, find_under(out, team, progress));
  std::vector<Inside> inside(map.texels.size());
  const WallSearch search{{out}, inside};
  LUXEL_TRY(const Walls walls, search.find_walls(team, progress));
  out.mixed = blocks_of(map, walls.parted), out.beside_solids = blocks_of(map, walls.beside);
  return out;
}

OwnSides find_own_sides(const scene::Scene& scene, const atlas::Atlas& atlas,
                        const atlas::TexelMap& map, const trace::RayTracer& tracer) {
  Progress nobody;
  return *find_own_sides(scene, atlas, map, tracer, nullptr, nobody);  // nothing can fail
}

}  // namespace luxel::transport
