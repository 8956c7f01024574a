#include "luxel/solve/gather/bounce/sweep.h"

#include <algorithm>
#include <utility>

#include "luxel/base/check.h"
#include "luxel/base/parallel.h"
#include "luxel/solve/gather/rays/own_tiles.h"
#include "luxel/solve/gather/rays/ray_device.h"
#include "luxel/solve/gather/rays/tile_hits.h"

namespace luxel::gather {
namespace {

void prefetch(const RadiosityMap& m, StoredHit hit) {
  const Float4* upper = m.texels.data() + hit.base();
  __builtin_prefetch(upper), __builtin_prefetch(upper + m.stride);
}

}  // namespace

void gather_round(const RadiosityMap& m, std::span<const StoredHit> hits, bool last, Gathered& g) {
  Gathered round;
  for (size_t k = 0; k < hits.size(); ++k) {
    const StoredHit& hit = hits[k];
    if (k + kAhead < hits.size()) prefetch(m, hits[k + kAhead]);
    const Float4 b = lookup(m, hit);
    const float l = luminance({b[0], b[1], b[2]});
    round.sum += b;
    round.sum_luminance2 += l * l;
    round.first_less_second += last && hit.second_half() ? -l : l;
  }
  g.sum += round.sum;
  g.sum_luminance2 += round.sum_luminance2;
  g.first_less_second += round.first_less_second;
}

Rgb source_of(const TracedHits& hits, std::span<const Rgb> direct, size_t element) {
  return direct[element] + hits.sky[element] * (kPi / float(hits.samples[element]));
}

namespace {

/// Variance of the mean over an element's rays, taken as independent. Of rays that follow a guide,
/// r to a sample, each stands for r times what it counts.
float variance_of_mean(const Gathered& g, const TracedHits& hits, size_t element) {
  const float n = float(hits.samples[element]), r = rays_per_sample(hits, element);
  const float sum = luminance({g.sum[0], g.sum[1], g.sum[2]}) + kPi * luminance(hits.sky[element]);
  const float sum2 = g.sum_luminance2 + kPi * kPi * hits.sky_luminance2[element];
  return std::max(0.0f, r * sum2 / n - (sum / n) * (sum / n)) / (n * r);
}

/// ((A - B) / 2)^2 of the halves' means A and B; without halves, of one sample, there is nothing to
/// say.
float split_variance(const Gathered& g, const TracedHits& hits, size_t element) {
  const int samples = int(hits.samples[element]);
  if (samples < 2) return variance_of_mean(g, hits, element);
  const int first = (samples + 1) / 2, second = samples - first;
  const float sum = luminance({g.sum[0], g.sum[1], g.sum[2]}) + kPi * luminance(hits.sky[element]);
  const float difference = g.first_less_second + kPi * hits.sky_first_less_second[element];
  const float a = 0.5f * (sum + difference), b = 0.5f * (sum - difference);
  const float d = 0.5f * (a / float(first) - b / float(second));
  return d * d;
}

/// Gives an element the light of what its rays have gathered. Returns the squared change.
double update(const TracedHits& hits, size_t element, Float4 sum, Sweep& sweep) {
  const Rgb gathered = Rgb{sum[0], sum[1], sum[2]} * (1.0f / float(hits.samples[element]));
  const Rgb source = sweep.direct.empty() ? Rgb{} : source_of(hits, sweep.direct, element);
  const Rgb before = std::exchange(sweep.irradiance[element], source + gathered);
  const Rgb d = sweep.irradiance[element] - before;
  return double(dot(d, d));
}

/// Gives an element what its rays have gathered. Returns the squared change.
double take(const TracedHits& hits, size_t element, const Gathered& g, Sweep& sweep) {
  sweep.variance[element] = variance_of_mean(g, hits, element);
  sweep.split_variance[element] = split_variance(g, hits, element);
  return update(hits, element, g.sum, sweep);
}

/// Returns the sum of squared changes of a tile's elements.
double sweep_tile(const RadiosityMap& m, const TracedHits& hits, const TileHits& tile,
                  size_t first_element, Sweep& sweep) {
  double change2 = 0;
  const size_t end = std::min(first_element + kTileElements, hits.size());
  for (size_t i = first_element; i < end; ++i) {
    if (!sweep.only.empty() && !sweep.only[i]) continue;
    Gathered g;
    for (size_t r = hits.first_round[i]; r <= hits.last_round[i]; ++r)
      gather_round(m, tile.of(r, i - first_element), r == hits.last_round[i], g);
    change2 += take(hits, i, g, sweep);
  }
  return change2;
}

void add(const RadiosityMap& m, StoredHit hit, float weight, Float4& sum) {
  sum += lookup(m, hit) * weight;
}

double sweep_sparse(const RadiosityMap& m, const TracedHits& hits, const TileHits& tile,
                    size_t first_element, Sweep& sweep) {
  double change2 = 0;
  const size_t end = std::min(first_element + kTileElements, hits.size());
  for (size_t i = first_element; i < end; ++i) {
    Float4 sum{};
    for_each_sparse(hits, tile, i, sweep.stride,
                    [&](StoredHit hit, float weight) { add(m, hit, weight, sum); });
    change2 += update(hits, i, sum, sweep);
  }
  return change2;
}

/// Sweeps a tile of the copy, which gives the bits of sweep_sparse().
double sweep_subsampled(const RadiosityMap& m, const TracedHits& hits,
                        const SubsampledHits::Tile& tile, size_t first_element, Sweep& sweep) {
  double change2 = 0;
  uint32_t hit = 0;
  for (size_t k = 0; k < tile.end.size(); ++k) {
    Float4 sum{};
    for (; hit < tile.end[k]; ++hit) {
      if (hit + kAhead < tile.hits.size()) prefetch(m, tile.hits[hit + kAhead]);
      add(m, tile.hits[hit], tile.weight[hit], sum);
    }
    change2 += update(hits, first_element + k, sum, sweep);
  }
  return change2;
}

/// A sweep by the device that has the hits. Errors: those of the device, cancelled.
Status sweep_on_device(const RadiosityMap& m, const TracedHits& hits, Sweep& sweep,
                       Progress& progress) {
  LUXEL_CHECK(sweep.stride == 1);
  std::vector<Gathered> gathered(hits.size());
  LUXEL_TRY_STATUS(hits.device->sweep(m, gathered));
  parallel_for(hits.size(), kTileElements, [&](size_t begin, size_t end) {
    double& change2 = sweep.change2[begin / kTileElements];
    for (size_t i = begin; i < end; ++i)
      if (sweep.only.empty() || sweep.only[i]) change2 += take(hits, i, gathered[i], sweep);
  });
  return stopped(progress);
}

}  // namespace

namespace {

/// A sweep over the hits that are here. Errors: the file of hits cannot be read, cancelled.
Status sweep_own(const RadiosityMap& m, const TracedHits& hits, Sweep& sweep, Progress& progress) {
  if (!sweep.subsampled)
    return for_each_tile(hits, progress, [&](size_t t, const TileHits& tile) {
      const size_t first = t * kTileElements;
      sweep.change2[t] = sweep.stride > 1 ? sweep_sparse(m, hits, tile, first, sweep)
                                          : sweep_tile(m, hits, tile, first, sweep);
    });
  LUXEL_CHECK(sweep.subsampled->stride == sweep.stride);
  return for_each_tile(
      *sweep.subsampled, progress, [&](size_t t, const SubsampledHits::Tile& tile) {
        sweep.change2[t] = sweep_subsampled(m, hits, tile, t * kTileElements, sweep);
      });
}

/// Gives all members of a team what each has swept. Errors: those of exchange().
Status give_swept(const TracedHits& hits, Sweep& sweep, Progress& progress) {
  const auto light = [&](size_t t) { return of_tile(sweep.irradiance, t, hits.size()); };
  return exchange(hits.team, own_tiles(hits),
                  {sweep.change2.size(),
                   [&](size_t t, ByteWriter& out) {
                     out.put_value(sweep.change2[t]), out.put(std::as_bytes(light(t)));
                   },
                   [&](size_t t, uint32_t, ByteReader& in) {
                     sweep.change2[t] = in.get_value<double>();
                     in.get(std::as_writable_bytes(light(t)));
                     return in.ok;
                   }},
                  progress);
}

}  // namespace

Status run_sweep(const RadiosityMap& m, const TracedHits& hits, Sweep& sweep, Progress& progress) {
  sweep.change2.assign(tile_count(hits), 0.0);
  if (hits.device) return sweep_on_device(m, hits, sweep, progress);
  LUXEL_TRY_STATUS(sweep_own(m, hits, sweep, progress));
  return hits.team ? give_swept(hits, sweep, progress) : Status();
}

Status give_variances(const TracedHits& hits, std::span<float> variance,
                      std::span<float> split_variance, Progress& progress) {
  return give_own_tiles(hits, 1, progress, variance, split_variance);
}

}  // namespace luxel::gather
