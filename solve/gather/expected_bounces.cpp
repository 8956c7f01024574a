#include "solve/gather/expected_bounces.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "base/clock.h"
#include "solve/gather/convergence.h"
#include "solve/gather/sweep.h"
#include "solve/gather/tile_hits.h"

namespace luxel::gather {
namespace {

/// Looks all hits up. Returns how many they are.
size_t look_up_all(const RadiosityMap& m, const TracedHits& hits, Gathered& g) {
  size_t looked_at = 0;
  for (const HitStore& round : hits.rounds)
    for (size_t t = 0; t < round.tile_count(); ++t) {
      HitTile buffer;
      const Result<const HitTile*> tile = round.get(t, buffer);
      if (!tile) continue;
      gather_round(m, (*tile)->entries, true, g);
      looked_at += (*tile)->entries.size();
    }
  return looked_at;
}

}  // namespace

double seconds_per_hit(const atlas::TexelMap& map, const TracedHits& hits) {
  const RadiosityMap m = empty_radiosity_map(map.resolution);
  Gathered g;
  // Once to bring the map into caches: a sweep has many times as many hits and finds it there.
  look_up_all(m, hits, g);
  const auto start = Clock::now();
  const size_t looked_at = look_up_all(m, hits, g);
  const double seconds = seconds_since(start);
  // The sum is zero, which the compiler does not know.
  return looked_at == 0 ? 0 : (seconds + double(g.sum[0])) / double(looked_at);
}

namespace {

/// A sweep over every 16th or 4th ray takes longer than that part of one over all rays, which has
/// neighbouring hits at hand: 1.25 to 1.4 times that. To copy every 16th hit takes about a third of
/// a sweep. (Intel Xeon, 1024 x 1024, four scenes.)
constexpr double kSparseCost = 1.3, kCopyCost = 0.3;

/// So many hits of an element are looked at: rooms are what decides, not noise.
constexpr size_t kHitsLookedAt = 16;

constexpr int kMostSweeps = 200;

/// Where elements were tried, and for places where none were the nearest in the map.
struct TriedCells {
  static constexpr uint32_t kCell = 8;  ///< texels along a side
  static constexpr uint32_t kUnknown = UINT32_MAX;

  uint32_t across = 0;
  std::vector<std::vector<uint32_t>> tried;  ///< per cell, numbers among those tried
  std::vector<uint32_t> nearest;             ///< per cell, the nearest that has some

  uint32_t cell_of(const atlas::Texel& t) const { return t.y / kCell * across + t.x / kCell; }
  std::span<const uint32_t> near(const atlas::Texel& t) const { return tried[nearest[cell_of(t)]]; }
};

TriedCells find_cells(const atlas::TexelMap& map, std::span<const uint32_t> tried) {
  TriedCells out;
  out.across = uint32_t(map.resolution) / TriedCells::kCell + 1;
  out.tried.resize(size_t(out.across) * out.across);
  out.nearest.assign(out.tried.size(), TriedCells::kUnknown);
  std::vector<uint32_t> queue;
  const auto reach = [&](uint32_t cell, uint32_t from) {
    if (out.nearest[cell] == TriedCells::kUnknown) out.nearest[cell] = from, queue.push_back(cell);
  };
  for (uint32_t k = 0; k < tried.size(); ++k) {
    const uint32_t cell = out.cell_of(map.texels[tried[k]]);
    out.tried[cell].push_back(k), reach(cell, cell);
  }
  for (size_t head = 0; head < queue.size(); ++head) {
    const uint32_t cell = queue[head], x = cell % out.across, y = cell / out.across;
    const uint32_t from = out.nearest[cell];
    if (x > 0) reach(cell - 1, from);
    if (x + 1 < out.across) reach(cell + 1, from);
    if (y > 0) reach(cell - out.across, from);
    if (y + 1 < out.across) reach(cell + out.across, from);
  }
  return out;
}

/// One of the elements that a hit lies between, or none.
uint32_t element_at(const atlas::TexelMap& map, const StoredHit& hit) {
  const uint32_t stride = uint32_t(map.resolution) + 2;  // the map of radiosity has a border
  for (const uint32_t step : {0u, 1u, stride, stride + 1}) {
    const uint32_t at = hit.base() + step, x = at % stride, y = at / stride;
    if (x == 0 || y == 0 || x + 1 >= stride || y + 1 >= stride) continue;
    const uint32_t i = map.texel_at[size_t(y - 1) * size_t(map.resolution) + (x - 1)];
    if (i != atlas::kNone) return i;
  }
  return atlas::kNone;
}

/// The elements tried, bounced by themselves.
struct TriedLight {
  struct Link {
    uint32_t from;  ///< number among those tried
    float part;     ///< of its light that arrives
  };
  std::vector<Link> links;
  std::vector<size_t> link_end;  ///< per element tried
  std::vector<double> source, light;

  /// A sweep. Returns its root mean square change, relative to the mean.
  double sweep() {
    double change2 = 0, sum = 0;
    std::vector<double> next = source;
    for (size_t k = 0, l = 0; k < next.size(); ++k) {
      for (; l < link_end[k]; ++l) next[k] += double(links[l].part) * light[links[l].from];
      change2 += (next[k] - light[k]) * (next[k] - light[k]), sum += next[k];
    }
    light = std::move(next);
    return sum > 0 ? std::sqrt(change2 * double(light.size())) / sum : 0;
  }
};

/// Adds the light that reaches an element of `tried`, from one hit in some.
void add_links(const atlas::TexelMap& map, const transport::Elements& elements,
               const TriedCells& cells, const TracedHits& hits, size_t i, const TileHits& tile,
               TriedLight& out) {
  const size_t stride = std::max<size_t>(1, hits.samples[i] / kHitsLookedAt);
  const float part = float(stride) / float(hits.samples[i]);
  for (size_t r = 0; r <= hits.last_round[i]; ++r) {
    const std::span<const StoredHit> own = tile.of(r, i % kTileElements);
    for (size_t k = first_hit(i, stride, own.size()); k < own.size(); k += stride) {
      const uint32_t j = element_at(map, own[k]);
      if (j == atlas::kNone) continue;
      const std::span<const uint32_t> near = cells.near(map.texels[j]);
      out.links.push_back(
          {near[out.links.size() % near.size()], part * luminance(elements.reflectance[j])});
    }
  }
  out.link_end.push_back(out.links.size());
}

/// Errors: the file of hits cannot be read.
Result<TriedLight> tried_light(const atlas::TexelMap& map, const transport::Elements& elements,
                               const TriedHits& tried) {
  const TracedHits& hits = tried.hits;
  std::vector<uint32_t> own, element;  // those with samples: of `hits`, of all
  for (uint32_t i = 0; i < hits.size(); ++i)
    if (hits.samples[i] > 0) own.push_back(i), element.push_back(tried.element[i]);
  const TriedCells cells = find_cells(map, element);
  TriedLight out;
  TileHits tile;
  size_t tile_read = SIZE_MAX;
  for (const uint32_t i : own) {
    out.source.push_back(double(luminance(source_of(hits, tried.direct, i))));
    if (const size_t t = i / kTileElements; t != tile_read) {
      LUXEL_TRY_STATUS(tile.read(hits, t));
      tile_read = t;
    }
    add_links(map, elements, cells, hits, i, tile, out);
  }
  out.light = out.source;
  return out;
}

}  // namespace

Result<double> expected_sweeps(const atlas::TexelMap& map, const transport::Elements& elements,
                               const TriedHits& tried, int samples, const BounceParams& params) {
  LUXEL_CHECK(tried.element.size() == tried.hits.size() &&
              tried.direct.size() == tried.hits.size());
  if (params.bounces >= 0) return params.bounces;
  LUXEL_TRY(TriedLight light, tried_light(map, elements, tried));
  const ReflectanceRange range = reflectance_range(elements);
  double out = 0, ratio = 0;
  bool first = true;
  for (const size_t stride : kStrides) {
    if (!has_sweeps_of(stride, size_t(samples))) continue;
    const double cost = stride > 1 ? kSparseCost / double(stride) : 1;
    if (stride == kSparsest) out += kCopyCost;
    if (!first) {
      // Each step is a quarter of the one before, and so has to be what is left; one sweep more
      // averages the noise of the sparser ones.
      const double q = std::clamp(ratio, 0.1, 0.99);
      out += cost * (1 + std::log(4.0) / -std::log(q));
      continue;
    }
    double before = 0;
    for (int k = 0; k < kMostSweeps; ++k) {
      const double change = light.sweep();
      out += cost;
      if (before > 0) ratio = change / before;
      if (light_to_come(change, ratio, range) <= double(params.tolerance) * double(stride)) break;
      before = change;
    }
    first = false;
  }
  return out;
}

}  // namespace luxel::gather
