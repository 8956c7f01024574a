#include "luxel/atlas/footprint.h"

#include <algorithm>
#include <optional>

#include "luxel/atlas/cover.h"
#include "luxel/base/random.h"
#include "luxel/scene/drawn_triangle.h"

namespace luxel::atlas {
namespace {

constexpr int kTriesPerPoint = 16;

/// Where the triangle holds the place of the atlas, its border included.
std::optional<Barycentric> found_in(const std::array<Vec2, 3>& corners, DVec2 p) {
  const DVec2 a = to_double(corners[0]), ab = to_double(corners[1]) - a,
              ac = to_double(corners[2]) - a;
  const double area2 = cross(ab, ac);
  if (area2 == 0) return std::nullopt;
  const double u = cross(p - a, ac) / area2, v = cross(ab, p - a) / area2;
  if (u < 0 || v < 0 || u + v > 1) return std::nullopt;
  return Barycentric{float(u), std::min(float(v), 1 - float(u))};
}

/// Calls visit(k, triangle) for every triangle, in ascending order, and every texel k that it
/// covers some of.
template <class Visit>
void for_each_pair(const Atlas& atlas, const TexelMap& map, std::span<const uint32_t> asked,
                   const Visit& visit) {
  for (uint32_t t = 0; t < atlas.corners.size(); ++t) {
    const auto& c = atlas.corners[t];
    const UvTriangle triangle = uv_triangle({to_double(c[0]), to_double(c[1]), to_double(c[2])});
    if (triangle.area2 == 0) continue;
    const Span rows = touched_rows(triangle);
    for (int j = std::max(0, rows.begin); j < std::min(map.resolution, rows.end); ++j) {
      const Span columns = touched_texels(triangle, j);
      for (int i = std::max(0, columns.begin); i < std::min(map.resolution, columns.end); ++i) {
        const uint32_t texel = map.texel_at[size_t(j) * size_t(map.resolution) + size_t(i)];
        if (texel == kNone || asked[texel] == kNone) continue;
        if (atlas.chart[map.texels[texel].triangle_number] == atlas.chart[t])
          visit(asked[texel], t);
      }
    }
  }
}

}  // namespace

Cover cover_of(const Atlas& atlas, const TexelMap& map, std::span<const uint32_t> texels) {
  std::vector<uint32_t> asked(map.texels.size(), kNone);
  for (uint32_t k = 0; k < texels.size(); ++k) asked[texels[k]] = k;
  Cover cover;
  cover.first.assign(texels.size() + 1, 0);
  for_each_pair(atlas, map, asked, [&](uint32_t k, uint32_t) { ++cover.first[k + 1]; });
  for (size_t k = 0; k < texels.size(); ++k) cover.first[k + 1] += cover.first[k];
  cover.triangles.resize(cover.first.back());
  std::vector<uint32_t> next(cover.first.begin(), cover.first.end() - 1);
  for_each_pair(atlas, map, asked,
                [&](uint32_t k, uint32_t triangle) { cover.triangles[next[k]++] = triangle; });
  return cover;
}

void spread_points(const Atlas& atlas, const Texel& texel, std::span<const uint32_t> cover,
                   int count, uint64_t seed, std::vector<scene::SurfacePoint>& points) {
  points.clear();
  const uint64_t scramble = hash64(seed, (uint64_t(texel.y) << 32) | texel.x);
  for (int k = 0; k < kTriesPerPoint * count && points.size() < size_t(count); ++k) {
    const Vec2 u = sobol_owen_2d(uint32_t(k), scramble);
    const DVec2 p{double(texel.x) + double(u.x), double(texel.y) + double(u.y)};
    for (const uint32_t triangle : cover) {
      const auto at = found_in(atlas.corners[triangle], p);
      if (!at) continue;
      const auto drawn = scene::drawn_triangle(atlas.first_triangle, triangle);
      points.push_back({drawn.instance, drawn.triangle, *at});
      break;
    }
  }
}

}  // namespace luxel::atlas
