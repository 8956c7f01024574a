#include "solve/gather/bounces.h"

#include <algorithm>
#include <mutex>

#include "base/check.h"
#include "base/parallel.h"

namespace luxel::gather {
namespace {

/// Four floats in one register: R, G, B and coverage.
typedef float Float4 __attribute__((vector_size(16)));

/// Radiosity rho E per texel of the map, with a border of one empty texel. Coverage is 1 where there
/// is an element, so that weights can be renormalised after a bilinear lookup.
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

void fill(RadiosityMap& m, const atlas::TexelMap& map, const transport::Elements& elements,
          std::span<const Rgb> irradiance) {
  parallel_for(map.texels.size(), 1 << 14, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const Rgb b = elements.reflectance[i] * irradiance[i];
      m.texels[size_t(map.texels[i].y + 1) * m.stride + map.texels[i].x + 1] =
          Float4{b.x, b.y, b.z, 1.0f};
    }
  });
}

inline Float4 lookup(const RadiosityMap& m, const StoredHit& hit) {
  constexpr float kUnit = 1.0f / 65535.0f;
  const float fx = float(hit.fx) * kUnit, fy = float(hit.fy) * kUnit;
  const Float4* upper = m.texels.data() + hit.base;
  const Float4* lower = upper + m.stride;
  const Float4 sum = (upper[0] * (1 - fx) + upper[1] * fx) * (1 - fy) +
                     (lower[0] * (1 - fx) + lower[1] * fx) * fy;
  // Coverage is positive: the texel that holds the hit has an element.
  return sum[3] > 0 ? sum * (1.0f / sum[3]) : Float4{};
}

struct Gathered {
  Float4 sum{};
  float sum_luminance2 = 0;
};

Gathered gather_element(const RadiosityMap& m, std::span<const StoredHit> hits) {
  Gathered g;
  for (const StoredHit& hit : hits) {
    const Float4 b = lookup(m, hit);
    const float l = luminance({b[0], b[1], b[2]});
    g.sum += b;
    g.sum_luminance2 += l * l;
  }
  return g;
}

/// One sweep's input and output. `change` holds one value per tile: a fixed order for the maximum.
struct Sweep {
  std::span<const Rgb> source;    ///< E_0
  std::span<const Rgb> previous;  ///< E of the sweep before
  std::span<Rgb> next;
  std::span<float> variance;
  std::vector<float> change;
};

Status run_sweep(const RadiosityMap& m, const TracedHits& hits, Sweep& sweep, Progress& progress) {
  const float per_ray = 1.0f / float(hits.samples);
  sweep.change.assign(hits.store.tile_count(), 0.0f);
  std::mutex mutex;
  Status status;
  parallel_for(hits.store.tile_count(), 1, [&](size_t t, size_t) {
    if (progress.cancelled()) return;
    HitTile buffer;
    const auto tile = hits.store.get(t, buffer);
    if (!tile) {
      const std::lock_guard lock(mutex);
      status = tl::unexpected(tile.error());
      return;
    }
    uint32_t first = 0;
    for (size_t k = 0; k < (*tile)->end.size(); ++k) {
      const size_t i = t * kTileElements + k;
      const uint32_t end = (*tile)->end[k];
      const Gathered g = gather_element(m, {(*tile)->hits.data() + first, end - first});
      first = end;
      const Rgb gathered = Rgb{g.sum[0], g.sum[1], g.sum[2]} * per_ray;
      sweep.next[i] = sweep.source[i] + gathered;
      const float mean = luminance(gathered);
      sweep.variance[i] = std::max(0.0f, g.sum_luminance2 * per_ray - mean * mean) * per_ray;
      const Rgb d = sweep.next[i] - sweep.previous[i];
      sweep.change[t] =
          std::max({sweep.change[t], std::abs(d.x), std::abs(d.y), std::abs(d.z)});
    }
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

}  // namespace

Result<Bounced> bounce(const atlas::TexelMap& map, const transport::Elements& elements,
                       const TracedHits& hits, std::span<const Rgb> direct, Rgb background,
                       const BounceParams& params, Progress& progress) {
  const size_t n = elements.size();
  LUXEL_CHECK(direct.size() == n && map.texels.size() == n && hits.escaped.size() == n);
  // E_0: what arrives without any reflection. A ray that escapes sees the background.
  std::vector<Rgb> source(direct.begin(), direct.end());
  float max_reflectance = 0;
  for (size_t i = 0; i < n; ++i) {
    source[i] += background * (kPi * float(hits.escaped[i]) / float(hits.samples));
    max_reflectance = std::max(max_reflectance, max_component(elements.reflectance[i]));
  }
  Bounced out;
  out.irradiance = source;
  out.variance.assign(n, 0.0f);
  std::vector<Rgb> next(n);
  RadiosityMap radiosity = empty_map(map.resolution);
  const float tail = max_reflectance / (1 - max_reflectance);
  progress.begin("bounces", 0);
  // With rho = 0.99 the tail falls below 1e-4 after 1,400 sweeps; more means that something is wrong.
  constexpr int kMaxSweeps = 4000;
  const int limit = params.bounces < 0 ? kMaxSweeps : params.bounces;
  while (out.sweeps < limit) {
    fill(radiosity, map, elements, out.irradiance);
    Sweep sweep{source, out.irradiance, next, out.variance, {}};
    LUXEL_TRY_STATUS(run_sweep(radiosity, hits, sweep, progress));
    out.irradiance.swap(next);
    ++out.sweeps;
    progress.advance(1);
    const float change = *std::max_element(sweep.change.begin(), sweep.change.end());
    if (params.bounces < 0 &&
        change * tail <= params.tolerance * float(mean_luminance(out.irradiance)))
      break;
  }
  return out;
}

}  // namespace luxel::gather
