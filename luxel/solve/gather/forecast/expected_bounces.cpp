#include "luxel/solve/gather/forecast/expected_bounces.h"

#include <algorithm>
#include <cmath>
#include <ctime>

#include "luxel/base/check.h"
#include "luxel/base/clock.h"
#include "luxel/solve/gather/bounce/convergence.h"
#include "luxel/solve/gather/bounce/sweep.h"
#include "luxel/solve/gather/rays/tile_hits.h"

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
  const std::clock_t start = std::clock();
  const size_t looked_at = look_up_all(m, hits, g);
  const double seconds = processor_seconds_since(start);
  // The sum is zero, which the compiler does not know.
  return looked_at == 0 ? 0 : (seconds + double(g.sum[0])) / double(looked_at);
}

namespace {

/// To copy every 16th hit takes about a third of a sweep.
constexpr double kCopyCost = 0.3;

/// So many hits of an element are looked at: rooms are what decides, not noise.
constexpr size_t kHitsLookedAt = 16;

/// So many sweeps are made of the trial; by then each is a known part of the one before.
constexpr int kMostSweeps = 100;

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
    Rgb part;       ///< of its light that arrives
  };
  std::vector<Link> links;
  std::vector<size_t> link_end;  ///< per element tried
  std::vector<Rgb> source, light;

  /// A sweep. Returns its root mean square change, relative to the mean luminance.
  double sweep() {
    double change2 = 0, sum = 0;
    std::vector<Rgb> next = source;
    for (size_t k = 0, l = 0; k < next.size(); ++k) {
      for (; l < link_end[k]; ++l) next[k] += links[l].part * light[links[l].from];
      const Rgb change = next[k] - light[k];
      change2 += double(dot(change, change)), sum += double(luminance(next[k]));
    }
    light = std::move(next);
    return sum > 0 ? std::sqrt(change2 / 3 * double(light.size())) / sum : 0;
  }
};

/// The part of element i's light that a hit on it sends on. Light on its other side is taken to be
/// equal.
Rgb sent_of(const transport::Elements& elements, uint32_t i, const StoredHit& hit) {
  const Rgb tau = elements.transmittance.empty() ? Rgb{} : elements.transmittance[i];
  const Rgb part = elements.reflectance[i] + tau;
  return hit.tint() == kNoTint ? part : part * unpack_tint(hit.tint());
}

/// Errors: the file of hits cannot be read.
Result<TriedLight> tried_light(const atlas::TexelMap& map, const transport::Elements& elements,
                               const TriedHits& tried) {
  const TracedHits& hits = tried.hits;
  std::vector<uint32_t> own, element;  // those with samples, in the open: of `hits`, of all
  for (uint32_t i = 0; i < hits.size(); ++i)
    if (hits.samples[i] > 0 && !is_hidden(hits, i))
      own.push_back(i), element.push_back(tried.element[i]);
  const TriedCells cells = find_cells(map, element);
  TriedLight out;
  TileHits tile;
  size_t tile_read = SIZE_MAX;
  for (const uint32_t i : own) {
    if (const size_t t = i / kTileElements; t != tile_read) {
      LUXEL_TRY_STATUS(tile.read(hits, t));
      tile_read = t;
    }
    const size_t stride = std::max<size_t>(1, hits.samples[i] / kHitsLookedAt);
    for_each_sparse(hits, tile, i, stride, [&](const StoredHit& hit, float weight) {
      const uint32_t j = element_at(map, hit);
      if (j == atlas::kNone) return;
      const std::span<const uint32_t> near = cells.near(map.texels[j]);
      out.links.push_back({near[out.links.size() % near.size()],
                           sent_of(elements, j, hit) * (weight / float(hits.samples[i]))});
    });
    out.link_end.push_back(out.links.size());
    out.source.push_back(source_of(hits, tried.direct, i));
  }
  out.light = out.source;
  return out;
}

/// Sweeps until the light to come is below `goal`, and the ratio of the last two changes.
struct FirstSweeps {
  double count = 0, ratio = 0;
};

FirstSweeps sweep_until(double goal, const ReflectanceRange& range, TriedLight& light) {
  FirstSweeps out;
  double before = 0;
  while (out.count < kMostSweeps) {
    const double change = light.sweep();
    ++out.count;
    if (before > 0) out.ratio = change / before;
    before = change;
    if (light_to_come(change, out.ratio, range) <= goal) return out;
  }
  const double to_come = light_to_come(before, out.ratio, range);
  out.count += std::log(to_come / goal) / -std::log(std::clamp(out.ratio, 0.1, 0.99));
  return out;
}

}  // namespace

Result<double> expected_sweeps(const atlas::TexelMap& map, const transport::Elements& elements,
                               const TriedHits& tried, int samples, const BounceParams& params) {
  LUXEL_CHECK(tried.element.size() == tried.hits.size() &&
              tried.direct.size() == tried.hits.size());
  if (params.bounces >= 0) return params.bounces;
  LUXEL_TRY(TriedLight light, tried_light(map, elements, tried));
  const size_t sparsest = sparsest_stride(size_t(samples));
  const double goal = double(params.tolerance) * double(sparsest);
  const FirstSweeps first = sweep_until(goal, reflectance_range(elements), light);
  double out = sparsest == kSparsest ? kCopyCost : 0;
  for (const size_t stride : kStrides) {
    if (stride > sparsest) continue;
    const double count = stride == sparsest ? first.count : sweeps_of_later_stride(first.ratio);
    out += count * cost_of_sweep(stride);
  }
  return out;
}

}  // namespace luxel::gather
