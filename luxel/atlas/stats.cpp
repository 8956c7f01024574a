#include <algorithm>
#include <array>
#include <atomic>
#include <span>
#include <vector>

#include "luxel/atlas/atlas.h"
#include "luxel/atlas/cover.h"
#include "luxel/atlas/pages.h"
#include "luxel/atlas/shared_parts.h"
#include "luxel/base/parallel.h"
#include "luxel/scene/drawn_triangle.h"

namespace luxel::atlas {
namespace {

/// A triangle's contribution to the sums below.
struct Measure {
  double area = 0, uv_area = 0;
  double stretch2 =
      0;  ///< (a + c) / 2, the mean of the squared singular values of the map uv -> 3D
};

/// [Sander01, section 3]: with S_s and S_t the derivatives of the surface by the texture
/// coordinates, the squared L2 stretch is (S_s . S_s + S_t . S_t) / 2.
Measure measure(const scene::Triangle3& world, const std::array<Vec2, 3>& uv) {
  const DVec2 a = to_double(uv[0]), b = to_double(uv[1]), c = to_double(uv[2]);
  const DVec3 p = to_double(world.a), q = to_double(world.b), r = to_double(world.c);
  const double area2 = cross(b - a, c - a);
  Measure m{0.5 * length(cross(q - p, r - p)), 0.5 * std::abs(area2), 0};
  if (area2 == 0) return m;
  const DVec3 ds = (p * (b.y - c.y) + q * (c.y - a.y) + r * (a.y - b.y)) * (1 / area2);
  const DVec3 dt = (p * (c.x - b.x) + q * (a.x - c.x) + r * (b.x - a.x)) * (1 / area2);
  m.stretch2 = 0.5 * (dot(ds, ds) + dot(dt, dt));
  return m;
}

/// Calls visit(index into map.texels) for every texel that the triangle, moved by so much, touches.
template <class Visit>
void for_touched(const Atlas& atlas, const TexelMap& map, uint32_t number, const Visit& visit,
                 DVec2 moved = {}) {
  const auto& c = atlas.corners[number];
  const UvTriangle t =
      uv_triangle({to_double(c[0]) + moved, to_double(c[1]) + moved, to_double(c[2]) + moved});
  const int last = atlas.resolution - 1;
  const Span rows = touched_rows(t);
  for (int j = rows.begin; j < rows.end; ++j) {
    const Span span = touched_texels(t, j);
    for (int i = span.begin; i < span.end; ++i) {
      const uint32_t texel = map.texel_at[size_t(std::clamp(j, 0, last)) * size_t(last + 1) +
                                          size_t(std::clamp(i, 0, last))];
      if (texel != kNone) visit(texel);
    }
  }
}

/// The texels that are marked.
std::vector<uint32_t> numbers_of(std::span<const uint8_t> marked) {
  std::vector<uint32_t> all;
  for (uint32_t i = 0; i < marked.size(); ++i)
    if (marked[i]) all.push_back(i);
  return all;
}

/// `chart`: the triangle touches a texel of its chart. `own`: it owns a texel.
struct Found {
  bool chart = false, own = false;
};
Found find_texels(const Atlas& atlas, const TexelMap& map, uint32_t number) {
  Found found;
  for_touched(atlas, map, number, [&](uint32_t texel) {
    const uint32_t owner = map.texels[texel].triangle_number;
    found.chart = found.chart || atlas.chart[owner] == atlas.chart[number];
    found.own = found.own || owner == number;
  });
  return found;
}

}  // namespace

AtlasStats atlas_stats(const scene::Scene& scene, const Atlas& atlas, const TexelMap& map) {
  AtlasStats stats;
  stats.charts = atlas.chart_count;
  double room = 0;
  for (const Page& page : pages_of(atlas)) room += double(page.side) * double(page.side);
  stats.utilisation = double(map.texels.size()) / room;
  const uint32_t count = atlas.first_triangle.back();
  std::vector<Found> found(count);
  parallel_for(count, 1024, [&](size_t begin, size_t end) {
    for (size_t t = begin; t < end; ++t) found[t] = find_texels(atlas, map, uint32_t(t));
  });
  double area = 0, uv_area = 0, stretch = 0, stretched_area = 0;
  uint32_t owners = 0;
  for (uint32_t i = 0; i < scene.instances.size(); ++i)
    for (uint32_t t = atlas.first_triangle[i]; t < atlas.first_triangle[i + 1]; ++t) {
      const scene::Triangle3 world = scene::world_triangle(scene, i, t - atlas.first_triangle[i]);
      const Measure m = measure(world, atlas.corners[t]);
      area += m.area;
      uv_area += m.uv_area;
      if (m.uv_area > 0) {  // a triangle squeezed to a line has no finite stretch
        stretch += m.area * m.stretch2;
        stretched_area += m.area;
      }
      owners += found[t].own;
      stats.triangles_without_texel += !found[t].chart;
    }
  if (stretched_area > 0)
    stats.mean_stretch_l2 = std::sqrt(stretch / stretched_area) * std::sqrt(uv_area / area);
  stats.texels_per_metre = area > 0 ? std::sqrt(uv_area / area) : 0;
  stats.owning_triangles = count > 0 ? double(owners) / count : 0;
  return stats;
}

namespace {

/// The texels that triangles of other charts touch when they are moved by any of these.
std::vector<uint32_t> touched_by_others(const Atlas& atlas, const TexelMap& map,
                                        std::span<const DVec2> moves) {
  std::vector<uint32_t> chart_of;  // per texel
  chart_of.reserve(map.texels.size());
  for (const Texel& texel : map.texels) chart_of.push_back(atlas.chart[texel.triangle_number]);
  std::vector<uint8_t> marked(map.texels.size());
  parallel_for(atlas.corners.size(), 64, [&](size_t begin, size_t end) {
    for (size_t t = begin; t < end; ++t)
      for (const DVec2 moved : moves)
        for_touched(
            atlas, map, uint32_t(t),
            [&](uint32_t texel) {
              if (chart_of[texel] != atlas.chart[t])
                std::atomic_ref(marked[texel]).store(1, std::memory_order_relaxed);
            },
            moved);
  });
  return numbers_of(marked);
}

}  // namespace

std::vector<uint32_t> overlapping_texels(const Atlas& atlas, const TexelMap& map) {
  return touched_by_others(atlas, map, std::array{DVec2{}});
}

std::vector<SharedPart> shared_parts(const Atlas& atlas, const TexelMap& map) {
  std::vector<SharedPart> out;
  for (uint32_t t = 0; t < atlas.corners.size(); ++t) {
    const auto& c = atlas.corners[t];
    const UvTriangle uv = uv_triangle({to_double(c[0]), to_double(c[1]), to_double(c[2])});
    const auto drawn = scene::drawn_triangle(atlas.first_triangle, t);
    for_touched(atlas, map, t, [&](uint32_t texel) {
      const Texel& owned = map.texels[texel];
      if (atlas.chart[owned.triangle_number] == atlas.chart[t]) return;
      const Clip part = clip_to_texel(uv, owned.x, owned.y);
      if (!(part.area > 0)) return;
      const Vec2 at{float(part.centroid.x), float(part.centroid.y)};
      out.push_back(
          {texel, {drawn.instance, drawn.triangle, barycentric_in(c, at)}, float(part.area)});
    });
  }
  return out;
}

std::vector<uint32_t> blended_texels(const Atlas& atlas, const TexelMap& map) {
  // A look-up blends texels whose centres lie less than a texel away in x and in y. A triangle
  // looks a texel up if it reaches into the square of 2 x 2 texels about its centre: that square is
  // the texel four times, moved by half a texel each way.
  return touched_by_others(
      atlas, map,
      std::array{DVec2{-0.5, -0.5}, DVec2{0.5, -0.5}, DVec2{-0.5, 0.5}, DVec2{0.5, 0.5}});
}

}  // namespace luxel::atlas
