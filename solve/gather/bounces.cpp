#include "solve/gather/bounces.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numeric>
#include <utility>

#include "base/check.h"
#include "base/clock.h"
#include "base/parallel.h"
#include "solve/gather/tile_hits.h"

namespace luxel::gather {
namespace {

/// Four floats in one register: R, G, B and coverage.
typedef float Float4 __attribute__((vector_size(16)));

/// Radiosity rho E per texel of the map, with a border of one empty texel. Coverage is 1 where
/// there is an element that is not hidden, so that weights can be renormalised after a bilinear
/// lookup.
struct RadiosityMap {
  uint32_t stride = 0;
  std::vector<Float4> texels;
};

RadiosityMap empty_map(int resolution) {
  RadiosityMap m;
  m.stride = uint32_t(resolution + 2);
  m.texels.assign(size_t(m.stride) * m.stride, Float4{});
  return m;
}

/// `value_at(i)`: what element i sends.
template <class ValueAt>
void fill(RadiosityMap& m, const atlas::TexelMap& map, const TracedHits& hits,
          const ValueAt& value_at) {
  parallel_for(map.texels.size(), 1 << 14, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      if (is_hidden(hits, i)) continue;
      const Rgb b = value_at(i);
      m.texels[size_t(map.texels[i].y + 1) * m.stride + map.texels[i].x + 1] =
          Float4{b.x, b.y, b.z, 1.0f};
    }
  });
}

inline Float4 lookup(const RadiosityMap& m, const StoredHit& hit) {
  constexpr float kUnit = 1.0f / float(StoredHit::kSteps);
  const float fx = float(hit.fx()) * kUnit, fy = float(hit.fy()) * kUnit;
  const Float4* upper = m.texels.data() + hit.base();
  const Float4* lower = upper + m.stride;
  const Float4 sum =
      (upper[0] * (1 - fx) + upper[1] * fx) * (1 - fy) + (lower[0] * (1 - fx) + lower[1] * fx) * fy;
  // Coverage is zero only where all texels around the hit are hidden.
  const Float4 mean = sum[3] > 0 ? sum * (1.0f / sum[3]) : Float4{};
  if (hit.tint() == kNoTint) return mean;
  const Rgb tint = unpack_tint(hit.tint());
  return mean * Float4{tint.x, tint.y, tint.z, 1};
}

/// B = rho E + tau E behind. `behind` has one place per element, or none.
void fill_radiosity(RadiosityMap& m, const atlas::TexelMap& map,
                    const transport::Elements& elements, const TracedHits& hits,
                    std::span<const StoredHit> behind, std::span<const Rgb> irradiance) {
  const auto reflected = [&](size_t i) { return elements.reflectance[i] * irradiance[i]; };
  if (behind.empty()) return fill(m, map, hits, reflected);
  RadiosityMap light = empty_map(map.resolution);
  fill(light, map, hits, [&](size_t i) { return irradiance[i]; });
  fill(m, map, hits, [&](size_t i) {
    if (max_component(elements.transmittance[i]) <= 0) return reflected(i);
    const Float4 e = lookup(light, behind[i]);
    return reflected(i) + elements.transmittance[i] * Rgb{e[0], e[1], e[2]};
  });
}

struct Gathered {
  Float4 sum{};
  float sum_luminance2 = 0;
  float first_less_second = 0;  ///< luminance of the first half of the samples minus the other's
};

/// Adds every stride-th hit of a round from `first` on, counted for all of them. Only in the last
/// round of an element do hits know which half of all they belong to; before, all is of the first.
void gather_round(const RadiosityMap& m, std::span<const StoredHit> hits, size_t first,
                  size_t stride, bool last, Gathered& g) {
  Gathered round;
  size_t used = 0;
  for (size_t k = first; k < hits.size(); k += stride, ++used) {
    const Float4 b = lookup(m, hits[k]);
    const float l = luminance({b[0], b[1], b[2]});
    round.sum += b;
    round.sum_luminance2 += l * l;
    round.first_less_second += last && hits[k].second_half() ? -l : l;
  }
  if (used > 0 && used < hits.size()) round.sum *= float(hits.size()) / float(used);
  g.sum += round.sum;
  g.sum_luminance2 += round.sum_luminance2;
  g.first_less_second += round.first_less_second;
}

/// E_0 of an element: what arrives without any reflection. A ray that escapes sees the sky.
Rgb source_of(const TracedHits& hits, std::span<const Rgb> direct, size_t element) {
  return direct[element] + hits.sky[element] * (kPi / float(hits.samples[element]));
}

/// One sweep's input and output. `change2` holds the squared change per tile: summed in a fixed
/// order.
struct Sweep {
  std::span<const Rgb> direct;  ///< empty: E_0 is none
  std::span<Rgb> irradiance;    ///< E of the sweep before, then of this one
  std::span<float> variance;    ///< of the gathered part and the sky
  std::span<float> split_variance;
  size_t stride = 1;  ///< only every stride-th ray is looked at
  std::vector<double> change2;
};

/// Variance of the mean over an element's rays, taken as independent.
float variance_of_mean(const Gathered& g, const TracedHits& hits, size_t element) {
  const float n = float(hits.samples[element]);
  const float sum = luminance({g.sum[0], g.sum[1], g.sum[2]}) + kPi * luminance(hits.sky[element]);
  const float sum2 = g.sum_luminance2 + kPi * kPi * hits.sky_luminance2[element];
  return std::max(0.0f, sum2 / n - (sum / n) * (sum / n)) / n;
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

/// Returns the sum of squared changes of a tile's elements.
double sweep_tile(const RadiosityMap& m, const TracedHits& hits, const TileHits& tile,
                  size_t first_element, Sweep& sweep) {
  double change2 = 0;
  const size_t end = std::min(first_element + kTileElements, hits.size());
  for (size_t i = first_element; i < end; ++i) {
    Gathered g;
    for (size_t r = 0; r <= hits.last_round[i]; ++r) {
      const std::span<const StoredHit> own = tile.of(r, i - first_element);
      const size_t start = first_hit(i, sweep.stride, own.size());
      gather_round(m, own, start, sweep.stride, r == hits.last_round[i], g);
    }
    const Rgb gathered = Rgb{g.sum[0], g.sum[1], g.sum[2]} * (1.0f / float(hits.samples[i]));
    const Rgb source = sweep.direct.empty() ? Rgb{} : source_of(hits, sweep.direct, i);
    const Rgb before = std::exchange(sweep.irradiance[i], source + gathered);
    if (sweep.stride == 1) {
      sweep.variance[i] = variance_of_mean(g, hits, i);
      sweep.split_variance[i] = split_variance(g, hits, i);
    }
    const Rgb d = sweep.irradiance[i] - before;
    change2 += double(dot(d, d));
  }
  return change2;
}

Status run_sweep(const RadiosityMap& m, const TracedHits& hits, Sweep& sweep, Progress& progress) {
  const size_t tiles = (hits.size() + kTileElements - 1) / kTileElements;
  sweep.change2.assign(tiles, 0.0);
  std::mutex mutex;
  Status status;
  parallel_for(tiles, 1, [&](size_t t, size_t) {
    if (progress.cancelled()) return;
    TileHits tile;
    if (const Status read = tile.read(hits, t); !read) {
      const std::lock_guard lock(mutex);
      status = read;
      return;
    }
    sweep.change2[t] = sweep_tile(m, hits, tile, t * kTileElements, sweep);
  });
  if (!status) return status;
  if (progress.cancelled()) return fail(ErrorCode::cancelled, "stopped by the user");
  return {};
}

double mean_luminance(std::span<const Rgb> values) {
  double sum = 0;
  for (const Rgb& v : values) sum += luminance(v);
  return values.empty() ? 0 : sum / double(values.size());
}

/// With rho = 0.99 the light to come falls below 1e-4 after 1,400 sweeps; more means that something
/// is wrong.
constexpr int kMaxSweeps = 4000;

/// A guess whose light to come is more times the tolerance is brought closer by sparse sweeps:
/// until they change less than a part of their first change, or so many; what is left is taken for
/// a geometric series.
constexpr double kFarFrom = 4, kSmallPart = 0.03;
constexpr int kMaxSparse = 8;
/// Sparse sweeps may bring a guess so much less closer than the last time (1.46 was seen).
constexpr double kUnsure = 1.5;

/// About so many sweeps follow sparser ones.
constexpr double kSweepsAfterSparse = 3;

/// Of what surfaces send back of the light on both their sides.
struct ReflectanceRange {
  double mean = 0, max = 0;
};

ReflectanceRange reflectance_range(const transport::Elements& elements) {
  ReflectanceRange range;
  for (size_t i = 0; i < elements.size(); ++i) {
    const Rgb tau = elements.transmittance.empty() ? Rgb{} : elements.transmittance[i];
    const Rgb rho = elements.reflectance[i] + tau;
    range.mean += double(luminance(rho)) / double(elements.size());
    range.max = std::max(range.max, double(max_component(rho)));
  }
  return range;
}

/// The sum of all changes still to come when each is q times the one before: change q / (1 - q).
/// The ratio of two changes that follow each other tends to the largest q there is; it is not
/// trusted outside of what the reflectances allow. 0: nothing is known of it.
double light_to_come(double change, double ratio, const ReflectanceRange& reflectance) {
  const double seen = ratio > 0 ? ratio : reflectance.max;
  const double q = std::clamp(seen, reflectance.mean, reflectance.max);
  return change * q / (1 - q);
}

/// The solution on its way.
struct Bouncing {
  const atlas::TexelMap& map;
  const transport::Elements& elements;
  const TracedHits& hits;
  std::span<const Rgb> direct;
  std::span<const StoredHit> behind;
  Progress& progress;
  ReflectanceRange reflectance;
  RadiosityMap radiosity{};
  Bounced out{};

  Result<double> sweep(size_t stride);
  Result<double> look_ahead(std::vector<Rgb> change, size_t stride);
  Status settle(size_t stride, float tolerance);
  Status settle_guess(size_t sparse, float tolerance);
};

/// Returns the root mean square change, relative to the mean irradiance.
Result<double> Bouncing::sweep(size_t stride) {
  fill_radiosity(radiosity, map, elements, hits, behind, out.irradiance);
  Sweep sweep{direct, out.irradiance, out.variance, out.split_variance, stride, {}};
  LUXEL_TRY_STATUS(run_sweep(radiosity, hits, sweep, progress));
  ++out.sweeps;
  progress.advance(1);
  const double sum2 = std::accumulate(sweep.change2.begin(), sweep.change2.end(), 0.0);
  const double mean = mean_luminance(out.irradiance);
  return mean > 0 ? std::sqrt(sum2 / (3 * double(hits.size()))) / mean : 0.0;
}

/// Adds what a change makes of itself in later bounces, looking at some rays only: as exact,
/// relative to the change, as these are. Returns the ratio of its last two steps.
Result<double> Bouncing::look_ahead(std::vector<Rgb> change, size_t stride) {
  const size_t n = change.size();
  double first = 0, before = 0, ratio = 0;
  for (int k = 0; k < kMaxSparse; ++k) {
    fill_radiosity(radiosity, map, elements, hits, behind, change);
    Sweep sweep{{}, change, out.variance, out.split_variance, stride, {}};
    LUXEL_TRY_STATUS(run_sweep(radiosity, hits, sweep, progress));
    double sum2 = 0;
    for (size_t i = 0; i < n; ++i)
      out.irradiance[i] += change[i], sum2 += double(dot(change[i], change[i]));
    if (k == 0) first = sum2;
    ratio = before > 0 ? std::sqrt(sum2 / before) : 0, before = sum2;
    if (sum2 <= kSmallPart * kSmallPart * first) break;
  }
  // By now each step is nearly the same as the one before, but smaller.
  const double q = std::min(ratio, reflectance.max);
  const float left = float(q / (1 - q));
  for (size_t i = 0; i < n; ++i) out.irradiance[i] += change[i] * left;
  for (Rgb& e : out.irradiance) e = max(e, Rgb{});
  return ratio;
}

/// Sweeps until the light to come is below the tolerance.
Status Bouncing::settle(size_t stride, float tolerance) {
  double before = 0, ratio = 0;
  for (int k = 0; k < kMaxSweeps; ++k) {
    LUXEL_TRY(const double change, sweep(stride));
    if (before > 0) ratio = change / before;
    if (light_to_come(change, ratio, reflectance) <= double(tolerance) * double(stride)) break;
    before = change;
  }
  return {};
}

/// The same from a guess: what a sweep over all rays changes is carried on by sparse ones. How much
/// closer that has come is seen by the next, and is what can be expected of another time.
Status Bouncing::settle_guess(size_t sparse, float tolerance) {
  double before = 0, ratio = 0, to_come_before = 0;
  for (int k = 0; k < kMaxSweeps; ++k) {
    std::vector<Rgb> changed = out.irradiance;
    LUXEL_TRY(const double change, sweep(1));
    if (before > 0) ratio = change / before;
    const double to_come = light_to_come(change, ratio, reflectance);
    if (to_come <= double(tolerance)) break;
    before = change;
    const bool has_come_closer = to_come_before > to_come;
    if (!has_come_closer && to_come < kFarFrom * double(tolerance)) continue;
    for (size_t i = 0; i < changed.size(); ++i) changed[i] = out.irradiance[i] - changed[i];
    LUXEL_TRY(ratio, look_ahead(std::move(changed), sparse));
    if (has_come_closer && kUnsure * to_come * to_come / to_come_before <= double(tolerance)) break;
    to_come_before = to_come;
    before = 0;  // the next change does not follow this one
  }
  return {};
}

}  // namespace

Result<Bounced> bounce(const atlas::TexelMap& map, const transport::Elements& elements,
                       const TracedHits& hits, std::span<const Rgb> direct,
                       std::span<const StoredHit> behind, const BounceParams& params,
                       Progress& progress) {
  const size_t n = elements.size();
  LUXEL_CHECK(direct.size() == n && map.texels.size() == n && hits.sky.size() == n);
  LUXEL_CHECK(behind.size() == elements.transmittance.size());
  Bouncing work{map, elements, hits, direct, behind, progress, reflectance_range(elements)};
  const bool guessed = params.bounces < 0 && !params.start.empty();
  LUXEL_CHECK(!guessed || params.start.size() == n);
  work.out.irradiance.assign(guessed ? params.start.begin() : direct.begin(),
                             guessed ? params.start.end() : direct.end());
  if (!guessed)
    for (size_t i = 0; i < n; ++i) work.out.irradiance[i] = source_of(hits, direct, i);
  work.out.variance.assign(n, 0.0f), work.out.split_variance.assign(n, 0.0f);
  work.radiosity = empty_map(map.resolution);
  progress.begin("bounces", 0);
  for (int k = 0; k < params.bounces; ++k) {
    const Result<double> change = work.sweep(1);
    if (!change) return tl::unexpected(change.error());
  }
  if (params.bounces >= 0) return std::move(work.out);
  const size_t fewest = hits.samples.empty() ? 0 : *std::ranges::min_element(hits.samples);
  const size_t sparse = fewest >= 256 ? 16 : fewest >= 64 ? 4 : 1;
  if (guessed && sparse > 1) {
    LUXEL_TRY_STATUS(work.settle_guess(sparse, params.tolerance));
    return std::move(work.out);
  }
  for (const size_t stride : {size_t(16), size_t(4), size_t(1)}) {
    if (stride > 1 && (guessed || fewest < 16 * stride)) continue;
    LUXEL_TRY_STATUS(work.settle(stride, params.tolerance));
  }
  return std::move(work.out);
}

double seconds_per_hit(const atlas::TexelMap& map, const TracedHits& hits) {
  const RadiosityMap m = empty_map(map.resolution);
  const auto start = Clock::now();
  Gathered g;
  size_t looked_at = 0;
  for (const HitStore& round : hits.rounds)
    for (size_t t = 0; t < round.tile_count(); ++t) {
      HitTile buffer;
      const Result<const HitTile*> tile = round.get(t, buffer);
      if (!tile) continue;
      gather_round(m, (*tile)->entries, 0, 1, true, g);
      looked_at += (*tile)->entries.size();
    }
  const double seconds = seconds_since(start);
  // The sum is zero, which the compiler does not know.
  return looked_at == 0 ? 0 : (seconds + double(g.sum[0])) / double(looked_at);
}

double expected_sweeps(const atlas::TexelMap& map, const transport::Elements& elements,
                       const TracedHits& hits, int samples, const BounceParams& params) {
  if (params.bounces >= 0) return params.bounces;
  // What a sweep leaves of the light, in the mean: the reflectance that rays see.
  const uint32_t stride = uint32_t(map.resolution + 2);
  double sum = 0, rays = 0;
  for (const uint16_t n : hits.samples) rays += double(n);
  for (const HitStore& round : hits.rounds)
    for (size_t t = 0; t < round.tile_count(); ++t) {
      HitTile buffer;
      const Result<const HitTile*> tile = round.get(t, buffer);
      if (!tile) continue;
      for (const StoredHit& hit : (*tile)->entries) {
        const uint32_t x = hit.base() % stride, y = hit.base() / stride;
        if (x == 0 || y == 0) continue;
        const uint32_t i = map.texel_at[size_t(y - 1) * size_t(map.resolution) + (x - 1)];
        if (i != atlas::kNone) sum += double(luminance(elements.reflectance[i]));
      }
    }
  const double q = std::clamp(sum / std::max(rays, 1.0), 0.01, 0.99);
  double out = 0;
  bool first = true;
  for (const size_t step : {size_t(16), size_t(4), size_t(1)}) {
    if (step > 1 && size_t(samples) < 16 * step) continue;
    // Until q^k q / (1 - q) is below the tolerance; what the sparser sweeps leave is their noise,
    // which few sweeps average out.
    const double end = double(params.tolerance) * double(step) * (1 - q) / q;
    const double sweeps = first ? std::max(1.0, std::log(end) / std::log(q)) : kSweepsAfterSparse;
    out += sweeps / double(step);
    first = false;
  }
  return out;
}

}  // namespace luxel::gather
