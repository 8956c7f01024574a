#include <algorithm>

#include "luxel/atlas/atlas.h"
#include "luxel/atlas/cover.h"
#include "luxel/base/check.h"
#include "luxel/base/free_memory.h"
#include "luxel/base/parallel.h"
#include "luxel/scene/drawn_triangle.h"

namespace luxel::atlas {
namespace {

constexpr int kBandRows = 16;

struct Owner {
  uint32_t triangle = kNone;
  bool centre = false;
  double area = -1;
};

UvTriangle triangle_at(const Atlas& atlas, uint32_t t) {
  const auto& c = atlas.corners[t];
  return uv_triangle({to_double(c[0]), to_double(c[1]), to_double(c[2])});
}

/// A place on the border x = resolution belongs to the last column.
Span kept_inside(Span span, int resolution) {
  return {std::clamp(span.begin, 0, resolution - 1), std::clamp(span.end, 1, resolution)};
}

/// The triangles that touch each band of rows, in ascending order.
std::vector<std::vector<uint32_t>> bin_triangles(const Atlas& atlas) {
  const int bands = (atlas.resolution + kBandRows - 1) / kBandRows;
  std::vector<std::vector<uint32_t>> bins{size_t(bands)};
  for (uint32_t t = 0; t < atlas.corners.size(); ++t) {
    const Span rows = kept_inside(touched_rows(triangle_at(atlas, t)), atlas.resolution);
    for (int b = rows.begin / kBandRows; b <= (rows.end - 1) / kBandRows; ++b)
      bins[size_t(b)].push_back(t);
  }
  return bins;
}

/// The centroid of a triangle's share of a texel as barycentric coordinates of its corners, which
/// keep the mesh's order. Strictly inside.
Barycentric sample_in(const std::array<DVec2, 3>& c, const UvTriangle& t, int column, int row) {
  const DVec2 centre{column + 0.5, row + 0.5};
  double u = 1.0 / 3, v = 1.0 / 3;
  if (t.area2 > 0) {
    DVec2 p = centre;
    if (!holds_texel(t, column, row)) {
      const Clip clip = clip_to_texel(t, column, row);
      p = clip.area > 0 ? clip.centroid : (c[0] + c[1] + c[2]) * (1.0 / 3);
    }
    const double area2 = cross(c[1] - c[0], c[2] - c[0]);
    u = cross(p - c[0], c[2] - c[0]) / area2;
    v = cross(c[1] - c[0], p - c[0]) / area2;
  } else {
    // Squeezed to a line: the place on its longest edge that is nearest to the centre.
    int k = 0;
    for (int e = 1; e < 3; ++e)
      if (length(c[(e + 1) % 3] - c[e]) > length(c[(k + 1) % 3] - c[k])) k = e;
    const DVec2 a = c[k], along = c[(k + 1) % 3] - a;
    const double l2 = dot(along, along);
    const double s = l2 > 0 ? std::clamp(dot(centre - a, along) / l2, 0.0, 1.0) : 0.5;
    std::array<double, 3> weight{};
    weight[size_t(k)] = 1 - s;
    weight[size_t((k + 1) % 3)] = s;
    u = weight[1], v = weight[2];
  }
  constexpr double kInside = 1e-5;  // keeps float rounding from leaving the triangle
  u = std::clamp(u, 0.0, 1.0), v = std::clamp(v, 0.0, 1.0 - u);
  const double shrink = 1 - 3 * kInside;
  return {float(kInside + shrink * u), float(kInside + shrink * v)};
}

/// The owners of one band of rows.
std::vector<Owner> find_owners(const Atlas& atlas, const std::vector<uint32_t>& bin, Span rows) {
  const int n = atlas.resolution;
  std::vector<Owner> owners(size_t(rows.end - rows.begin) * size_t(n));
  const auto owner = [&](int i, int j) -> Owner& {
    return owners[size_t(j - rows.begin) * size_t(n) + size_t(i)];
  };
  const auto rows_of = [&](const UvTriangle& t) {
    const Span all = kept_inside(touched_rows(t), n);
    return Span{std::max(all.begin, rows.begin), std::min(all.end, rows.end)};
  };
  for (const uint32_t number : bin) {
    const UvTriangle t = triangle_at(atlas, number);
    const Span mine = rows_of(t);
    for (int j = mine.begin; j < mine.end; ++j) {
      const Span s = centre_texels(t, j, CentreRule::inside_or_border);
      for (int i = std::max(0, s.begin); i < std::min(n, s.end); ++i)
        if (!owner(i, j).centre) owner(i, j) = {number, true, 1};
    }
  }
  for (const uint32_t number : bin) {
    const UvTriangle t = triangle_at(atlas, number);
    const Span mine = rows_of(t);
    for (int j = mine.begin; j < mine.end; ++j) {
      Span s = touched_texels(t, t.area2 == 0 ? std::min(j, touched_rows(t).end - 1) : j);
      if (s.empty()) {
        if (t.area2 > 0 || j != n - 1) continue;
        s = touched_texels(t, touched_rows(t).begin);  // lies on the border y = resolution
      }
      s = kept_inside(s, n);
      for (int i = s.begin; i < s.end; ++i) {
        Owner& o = owner(i, j);
        if (o.centre) continue;
        const double area = clip_to_texel(t, i, j).area;
        if (area > o.area + 1e-9) o = {number, false, area};
      }
    }
  }
  return owners;
}

std::vector<Texel> band_texels(const Atlas& atlas, const std::vector<Owner>& owners, Span rows) {
  const int n = atlas.resolution;
  std::vector<Texel> texels;
  uint32_t cached = kNone;
  scene::DrawnTriangle drawn;
  std::array<DVec2, 3> corners;
  UvTriangle triangle;
  for (size_t k = 0; k < owners.size(); ++k) {
    const Owner& o = owners[k];
    if (o.triangle == kNone) continue;
    // Texels of one triangle follow each other: what depends on it alone is worked out once.
    if (o.triangle != cached) {
      cached = o.triangle;
      drawn = scene::drawn_triangle(atlas.first_triangle, o.triangle);
      const auto& c = atlas.corners[o.triangle];
      corners = {to_double(c[0]), to_double(c[1]), to_double(c[2])};
      triangle = uv_triangle(corners);
    }
    Texel texel;
    texel.x = uint16_t(k % size_t(n));
    texel.y = uint16_t(size_t(rows.begin) + k / size_t(n));
    texel.sample = {drawn.instance, drawn.triangle,
                    sample_in(corners, triangle, int(texel.x), int(texel.y))};
    texel.triangle_number = o.triangle;
    texel.centre_covered = o.centre;
    texels.push_back(texel);
  }
  return texels;
}

}  // namespace

TexelMap rasterise(const scene::Scene&, const Atlas& atlas, std::shared_ptr<MappedMemory> memory) {
  const std::vector<std::vector<uint32_t>> bins = bin_triangles(atlas);
  std::vector<std::vector<Texel>> bands(bins.size());
  parallel_for(bins.size(), 1, [&](size_t begin, size_t end) {
    for (size_t b = begin; b < end; ++b) {
      const Span rows{int(b) * kBandRows, std::min(atlas.resolution, int(b + 1) * kBandRows)};
      bands[b] = band_texels(atlas, find_owners(atlas, bins[b], rows), rows);
    }
  });
  MappedVector<Texel> texels(std::move(memory));
  size_t count = 0;
  for (const auto& band : bands) count += band.size();
  texels.reserve(count);
  for (auto& band : bands) {
    texels.insert(texels.end(), band.begin(), band.end());
    free_memory(band);
  }
  return map_of(atlas, std::move(texels));
}

TexelMap map_of(const Atlas& atlas, MappedVector<Texel> texels) {
  TexelMap map{atlas.resolution, std::move(texels), {}};
  map.texel_at.assign(size_t(atlas.resolution) * size_t(atlas.resolution), kNone);
  for (uint32_t t = 0; t < map.texels.size(); ++t) {
    LUXEL_CHECK(int(map.texels[t].x) < atlas.resolution && int(map.texels[t].y) < atlas.resolution);
    map.texel_at[size_t(map.texels[t].y) * size_t(atlas.resolution) + map.texels[t].x] = t;
  }
  return map;
}

}  // namespace luxel::atlas
