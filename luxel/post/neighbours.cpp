#include "luxel/post/neighbours.h"

#include <algorithm>
#include <array>

#include "luxel/base/buffer_pool.h"
#include "luxel/base/check.h"
#include "luxel/base/share_out.h"
#include "luxel/post/texel_tile.h"

namespace luxel::post {
namespace {

/// Side of a texel in the world, per chart.
std::vector<float> chart_spacing(const scene::Scene& scene, const atlas::Atlas& atlas) {
  std::vector<double> world(atlas.chart_count), drawn(atlas.chart_count);
  for (uint32_t i = 0; i < scene.instances.size(); ++i)
    for (uint32_t n = atlas.first_triangle[i]; n < atlas.first_triangle[i + 1]; ++n) {
      const auto& c = atlas.corners[n];
      world[atlas.chart[n]] +=
          double(area_m2(scene::world_triangle(scene, i, n - atlas.first_triangle[i])));
      drawn[atlas.chart[n]] += 0.5 * std::abs(double(cross(c[1] - c[0], c[2] - c[0])));
    }
  std::vector<float> spacing(atlas.chart_count);
  for (size_t c = 0; c < spacing.size(); ++c)
    spacing[c] = drawn[c] > 0 ? float(std::sqrt(world[c] / drawn[c])) : 0.0f;
  return spacing;
}

/// Texels sorted by the cell of a grid that they lie in.
struct Grid {
  float cell_m = 1;
  Vec3 lower;
  std::vector<uint64_t> key;  ///< sorted
  std::vector<uint32_t> texel;

  std::array<int64_t, 3> cell_of(Vec3 p) const {
    const auto along = [&](float x, float x0) {
      return std::clamp<int64_t>(int64_t((x - x0) / cell_m), 0, (1 << 21) - 1);
    };
    return {along(p.x, lower.x), along(p.y, lower.y), along(p.z, lower.z)};
  }
  static uint64_t key_of(int64_t x, int64_t y, int64_t z) {
    return uint64_t(x) << 42 | uint64_t(y) << 21 | uint64_t(z);
  }
};

float median_spacing(const std::vector<SurfaceSample>& places) {
  std::vector<float> sizes;
  for (const SurfaceSample& p : places)
    if (p.spacing > 0) sizes.push_back(p.spacing);
  if (sizes.empty()) return 0;
  const auto middle = sizes.begin() + std::ptrdiff_t(sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end());
  return *middle;
}

Grid make_grid(const std::vector<SurfaceSample>& places, float cell_m) {
  Box3 box;
  for (const SurfaceSample& p : places) box.extend(p.position);
  Grid grid;
  grid.lower = box.lower;
  // 21 bits an axis.
  grid.cell_m = std::max(cell_m, box.diagonal() / float(1 << 20));
  std::vector<std::pair<uint64_t, uint32_t>> order;
  order.reserve(places.size());
  for (uint32_t i = 0; i < places.size(); ++i) {
    if (places[i].spacing <= 0) continue;
    const auto c = grid.cell_of(places[i].position);
    order.push_back({Grid::key_of(c[0], c[1], c[2]), i});
  }
  std::sort(order.begin(), order.end());
  for (const auto& [key, texel] : order) grid.key.push_back(key), grid.texel.push_back(texel);
  return grid;
}

/// True: a part of the texel's window is missing. Only there may its surface go on elsewhere. The
/// test looks at every other texel, for charts lie two apart. `self`: the texel in `cell`.
LUXEL_VECTOR_CLONES
bool is_near_a_border(const TexelTile& tile, const Around& self, size_t cell, int radius) {
  const int across = 2 * radius + 1;
  const size_t corner = cell - size_t(radius) * (tile.stride + 1);
  for (int first = 0; first < across; first += kLanes) {
    Float8 counts;
    lanes_within(first, across, counts);
    for (int k = 1; k < kLanes; k += 2) counts[k] = 0;
    for (int row = 0; row < across; row += 2) {
      NeighbourLanes at;
      neighbours_in(tile, self, corner + size_t(row) * tile.stride + size_t(first), at);
      const Int32x8 missing = (counts > Float8{}) & (at.weight <= Float8{});
      int any = 0;
      for (int k = 0; k < kLanes; ++k) any |= missing[k];
      if (any) return true;
    }
  }
  return false;
}

/// Per texel, 1: it takes part, and is_near_a_border().
Result<std::vector<uint8_t>> find_near_borders(const Neighbourhood& n, Team* team,
                                               Progress& progress) {
  std::vector<uint8_t> out(n.place.size());
  BufferPool<TexelTile> pool;
  const auto look = [&](size_t number) {
    TexelTile tile = pool.take();
    uint64_t looked_at = 0;
    fill_tile(
        n, number, n.radius, [](size_t) {}, [](size_t, uint32_t) {}, tile);
    for_texels_of(n, tile, n.radius, [&](uint32_t i, size_t cell) {
      if (n.place[i].spacing <= 0) return;
      // Twice the radius: the window's corners are farther away than its sides.
      const Around self = around(n.place[i], 2 * float(n.radius), n.min_cosine);
      out[i] = is_near_a_border(tile, self, cell, n.radius);
      ++looked_at;
    });
    progress.advance(looked_at * kBorderUnits);
    pool.give(std::move(tile));
  };
  LUXEL_TRY(const std::vector<uint32_t> own, luxel::share_out(team, tile_count(n), progress, look));
  LUXEL_TRY_STATUS(give_squares(team, own, n, progress, std::span(out)));
  return out;
}

struct Candidate {
  float distance2;
  uint32_t texel;
};

/// Neighbours of texel i that its window in the atlas does not hold.
void find_far(const Neighbourhood& n, const Grid& grid, uint32_t i, std::vector<Candidate>& found) {
  const SurfaceSample& own = n.place[i];
  const Around self = around(own, float(n.radius), n.min_cosine);
  const atlas::Texel& t = n.map->texels[i];
  // A texel far larger than most looks no farther than two cells.
  const float reach = std::min(float(n.radius) * own.spacing, 2 * grid.cell_m);
  const Vec3 r{reach, reach, reach};
  const auto low = grid.cell_of(own.position - r), high = grid.cell_of(own.position + r);
  for (int64_t x = low[0]; x <= high[0]; ++x)
    for (int64_t y = low[1]; y <= high[1]; ++y) {
      // Cells along z follow each other.
      auto at = std::lower_bound(grid.key.begin(), grid.key.end(), Grid::key_of(x, y, low[2]));
      for (; at != grid.key.end() && *at <= Grid::key_of(x, y, high[2]); ++at) {
        const uint32_t j = grid.texel[size_t(at - grid.key.begin())];
        const atlas::Texel& o = n.map->texels[j];
        if (std::abs(int(o.x) - int(t.x)) <= n.radius && std::abs(int(o.y) - int(t.y)) <= n.radius)
          continue;
        if (neighbour(self, n.place[j]).weight <= 0) continue;
        const Vec3 d = n.place[j].position - own.position;
        found.push_back({dot(d, d), j});
      }
    }
  std::sort(found.begin(), found.end(), [](const Candidate& a, const Candidate& b) {
    return a.distance2 != b.distance2 ? a.distance2 < b.distance2 : a.texel < b.texel;
  });
  if (found.size() > kMaxFar) found.resize(kMaxFar);
}

/// Gives all members of the team the blocks that each has filled. Errors: those of exchange().
Status give_far(Team* team, std::span<const uint32_t> own, Neighbourhood& n, Progress& progress) {
  return exchange(team, own,
                  {n.far.size(),
                   [&](size_t number, ByteWriter& out) {
                     const FarBlock& block = n.far[number];
                     out.put_value(uint32_t(block.end.size()));
                     out.put(std::span(block.end)), out.put(std::span(block.texel));
                   },
                   [&](size_t number, uint32_t, ByteReader& in) {
                     FarBlock& block = n.far[number];
                     const uint32_t texels = in.get_value<uint32_t>();
                     if (texels > kBlockTexels) return false;
                     block.end.resize(texels);
                     in.get(std::span(block.end));
                     const size_t count = texels == 0 ? 0 : block.end.back();
                     if (count > in.bytes.size() / sizeof(uint32_t)) return false;
                     block.texel.resize(count);
                     in.get(std::span(block.texel));
                     return in.ok;
                   }},
                  progress);
}

}  // namespace

Result<Neighbourhood> make_neighbourhood(const TexelGeometry& places, const DenoiseParams& params,
                                         Team* team, Progress& progress) {
  const size_t count = places.map.texels.size();
  LUXEL_CHECK(places.position.size() == count && places.normal.size() == count);
  LUXEL_CHECK(places.hidden.size() == count && params.radius >= 1);
  LUXEL_CHECK(places.region.empty() || places.region.size() == count);
  Neighbourhood n;
  n.map = &places.map;
  n.radius = int(params.radius);
  n.min_cosine = std::cos(params.max_normal_angle_rad);
  const std::vector<float> spacing = chart_spacing(places.scene, places.atlas);
  n.place.resize(count);
  for (size_t i = 0; i < count; ++i) {
    const uint32_t chart = places.atlas.chart[places.map.texels[i].triangle_number];
    n.place[i] = {places.position[i], places.hidden[i] ? 0.0f : spacing[chart], places.normal[i],
                  places.region.empty() ? 0 : places.region[i]};
  }
  n.far.resize((count + kBlockTexels - 1) / kBlockTexels);
  const float typical = median_spacing(n.place);
  if (typical <= 0) return n;
  const Grid grid = make_grid(n.place, float(n.radius) * typical);
  LUXEL_TRY(const std::vector<uint8_t> near_border, find_near_borders(n, team, progress));
  const auto find = [&](size_t number) {
    FarBlock& block = n.far[number];
    std::vector<Candidate> found;
    const size_t begin = number * kBlockTexels, end = std::min(begin + kBlockTexels, count);
    for (size_t i = begin; i < end && !progress.cancelled(); ++i) {
      found.clear();
      if (near_border[i]) find_far(n, grid, uint32_t(i), found);
      for (const Candidate& c : found) block.texel.push_back(c.texel);
      block.end.push_back(uint32_t(block.texel.size()));
    }
    progress.advance((end - begin) * kFarUnits);
  };
  LUXEL_TRY(const std::vector<uint32_t> own, luxel::share_out(team, n.far.size(), progress, find));
  LUXEL_TRY_STATUS(give_far(team, own, n, progress));
  return n;
}

}  // namespace luxel::post
