#include <algorithm>

#include "luxel/atlas/atlas.h"
#include "luxel/atlas/cover.h"
#include "luxel/atlas/pages.h"
#include "luxel/base/check.h"
#include "luxel/base/free_memory.h"
#include "luxel/base/parallel.h"
#include "luxel/base/share_out.h"
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

/// Columns and rows of a page.
struct PageSpans {
  Span columns, rows;
};
std::vector<PageSpans> spans_of_pages(const Atlas& atlas) {
  std::vector<PageSpans> out;
  for (const Page& p : pages_of(atlas)) out.push_back({{p.x, p.x + p.side}, {p.y, p.y + p.side}});
  return out;
}

/// A place on the border at the end belongs to the last column or row of its page.
Span kept_inside(Span span, Span page) {
  return {std::clamp(span.begin, page.begin, page.end - 1),
          std::clamp(span.end, page.begin + 1, page.end)};
}

/// The triangles that touch each band of rows, in ascending order.
std::vector<std::vector<uint32_t>> bin_triangles(const Atlas& atlas) {
  const int bands = (atlas.resolution + kBandRows - 1) / kBandRows;
  std::vector<std::vector<uint32_t>> bins{size_t(bands)};
  const std::vector<PageSpans> pages = spans_of_pages(atlas);
  for (uint32_t t = 0; t < atlas.corners.size(); ++t) {
    const Span rows =
        kept_inside(touched_rows(triangle_at(atlas, t)), pages[page_of(atlas, t)].rows);
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
  const std::vector<PageSpans> pages = spans_of_pages(atlas);
  const auto rows_of = [&](const UvTriangle& t, const PageSpans& page) {
    const Span all = kept_inside(touched_rows(t), page.rows);
    return Span{std::max(all.begin, rows.begin), std::min(all.end, rows.end)};
  };
  for (const uint32_t number : bin) {
    const UvTriangle t = triangle_at(atlas, number);
    const PageSpans& page = pages[page_of(atlas, number)];
    const Span mine = rows_of(t, page);
    for (int j = mine.begin; j < mine.end; ++j) {
      const Span s = centre_texels(t, j, CentreRule::inside_or_border);
      for (int i = std::max(page.columns.begin, s.begin); i < std::min(page.columns.end, s.end);
           ++i)
        if (!owner(i, j).centre) owner(i, j) = {number, true, 1};
    }
  }
  for (const uint32_t number : bin) {
    const UvTriangle t = triangle_at(atlas, number);
    const PageSpans& page = pages[page_of(atlas, number)];
    const Span mine = rows_of(t, page);
    for (int j = mine.begin; j < mine.end; ++j) {
      Span s = touched_texels(t, t.area2 == 0 ? std::min(j, touched_rows(t).end - 1) : j);
      if (s.empty()) {
        if (t.area2 > 0 || j != page.rows.end - 1) continue;
        s = touched_texels(t, touched_rows(t).begin);  // lies on the page's lower border
      }
      s = kept_inside(s, page.columns);
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

std::vector<Texel> texels_of_band(const Atlas& atlas, const std::vector<uint32_t>& bin,
                                  size_t band) {
  const Span rows{int(band) * kBandRows, std::min(atlas.resolution, int(band + 1) * kBandRows)};
  return band_texels(atlas, find_owners(atlas, bin, rows), rows);
}

/// All bands, which are freed.
MappedVector<Texel> joined(std::vector<std::vector<Texel>> bands,
                           std::shared_ptr<MappedMemory> memory) {
  MappedVector<Texel> texels(std::move(memory));
  size_t count = 0;
  for (const auto& band : bands) count += band.size();
  texels.reserve(count);
  for (auto& band : bands) {
    texels.insert(texels.end(), band.begin(), band.end());
    free_memory(band);
  }
  return texels;
}

/// A texel as it is sent: without data that follow from its triangle.
struct SentTexel {
  uint16_t x = 0, row_in_band = 0;
  uint32_t triangle_number : 31 = 0;
  bool centre_covered : 1 = false;
  Barycentric at;
};
static_assert(sizeof(SentTexel) == 16);

void put_band(const std::vector<Texel>& band, ByteWriter& out) {
  std::vector<SentTexel> sent;
  sent.reserve(band.size());
  for (const Texel& t : band)
    sent.push_back(
        {t.x, uint16_t(t.y % kBandRows), t.triangle_number, t.centre_covered, t.sample.at});
  out.put_value(uint64_t(sent.size()));
  out.put(std::span<const SentTexel>(sent));
}

/// False: this is no band of the atlas.
bool take_band(const Atlas& atlas, size_t band, ByteReader& in, std::vector<Texel>& out) {
  const uint64_t count = in.get_value<uint64_t>();
  if (count > in.bytes.size() / sizeof(SentTexel)) return false;
  std::vector<SentTexel> sent(count);
  in.get(std::span<SentTexel>(sent));
  out.reserve(count);
  for (const SentTexel& s : sent) {
    const size_t y = band * kBandRows + s.row_in_band;
    if (s.triangle_number >= atlas.corners.size() || int(s.x) >= atlas.resolution ||
        y >= size_t(atlas.resolution))
      return false;
    Texel t;
    t.x = s.x, t.y = uint16_t(y);
    const auto drawn = scene::drawn_triangle(atlas.first_triangle, s.triangle_number);
    t.sample = {drawn.instance, drawn.triangle, s.at};
    t.triangle_number = s.triangle_number, t.centre_covered = s.centre_covered;
    out.push_back(t);
  }
  return in.ok;
}

}  // namespace

TexelMap rasterise(const scene::Scene&, const Atlas& atlas, std::shared_ptr<MappedMemory> memory) {
  const std::vector<std::vector<uint32_t>> bins = bin_triangles(atlas);
  std::vector<std::vector<Texel>> bands(bins.size());
  parallel_for(bins.size(), 1, [&](size_t begin, size_t end) {
    for (size_t b = begin; b < end; ++b) bands[b] = texels_of_band(atlas, bins[b], b);
  });
  return map_of(atlas, joined(std::move(bands), std::move(memory)));
}

Result<TexelMap> rasterise_together(const scene::Scene& scene, const Atlas& atlas, Team* team,
                                    std::shared_ptr<MappedMemory> memory, Progress& progress) {
  if (!team) return rasterise(scene, atlas, std::move(memory));
  const std::vector<std::vector<uint32_t>> bins = bin_triangles(atlas);
  std::vector<std::vector<Texel>> bands(bins.size());
  LUXEL_TRY(const std::vector<uint32_t> own, share_out(team, bins.size(), progress, [&](size_t b) {
              bands[b] = texels_of_band(atlas, bins[b], b);
            }));
  LUXEL_TRY_STATUS(exchange(
      team, own,
      {bins.size(), [&](size_t b, ByteWriter& out) { put_band(bands[b], out); },
       [&](size_t b, uint32_t, ByteReader& in) { return take_band(atlas, b, in, bands[b]); }},
      progress));
  return map_of(atlas, joined(std::move(bands), std::move(memory)));
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
