#include "luxel/solve/gather/bounce/bounce_layers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "luxel/base/check.h"
#include "luxel/base/parallel.h"
#include "luxel/base/vectorize.h"
#include "luxel/light/light_layers.h"
#include "luxel/solve/gather/bounce/convergence.h"
#include "luxel/solve/gather/bounce/subsampled_hits.h"
#include "luxel/solve/gather/rays/own_tiles.h"
#include "luxel/solve/gather/rays/tile_hits.h"

namespace luxel::gather {
namespace {

/// Layers that a sweep looks up at once: R, G and B of five, and coverage, are one cache line.
constexpr size_t kLayerBlock = 5;
constexpr size_t kLanes = 3 * kLayerBlock + 1, kCoverage = kLanes - 1;

struct alignas(64) BlockTexel {
  std::array<float, kLanes> value{};
};
static_assert(sizeof(BlockTexel) == kLayerMapBytesPerTexel);

/// As bounces.cpp's map of radiosity, with a border of one empty texel.
struct BlockMap {
  uint32_t stride = 0;
  std::vector<BlockTexel> texels;
};

/// Light layer by layer for each element.
struct LightOfLayers {
  std::span<Rgb> light;
  size_t layers = 0;

  std::span<Rgb> of(size_t element, size_t first, size_t count) const {
    return light.subspan(element * layers + first, count);
  }
};

/// Layers first, first + 1, ... of all.
struct Block {
  size_t first = 0, count = 0;
};

BlockMap empty_map(int resolution) {
  BlockMap m;
  m.stride = uint32_t(resolution + 2);
  m.texels.resize(size_t(m.stride) * m.stride);
  return m;
}

/// `value_at(i, l)`: what element i sends of the block's l-th layer.
template <class ValueAt>
void fill(BlockMap& m, const atlas::TexelMap& map, const TracedHits& hits, const Block& block,
          const ValueAt& value_at) {
  parallel_for(map.texels.size(), 1 << 14, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      if (is_hidden(hits, i)) continue;
      auto& texel = m.texels[size_t(map.texels[i].y + 1) * m.stride + map.texels[i].x + 1].value;
      for (size_t l = 0; l < block.count; ++l) {
        const Rgb b = value_at(i, l);
        texel[3 * l] = b.x, texel[3 * l + 1] = b.y, texel[3 * l + 2] = b.z;
      }
      texel[kCoverage] = 1;
    }
  });
}

/// Light that arrives from a block's layers, in lanes as those of the map.
struct Lanes {
  Float8 low{}, high{};
};

/// Adds `weight` times what a hit sends, in its tint.
[[gnu::always_inline]] inline void add(const StoredHit& hit, float weight, const Lanes& sent,
                                       Lanes& sum) {
  weight *= hit.weight();
  if (hit.tint() == kNoTint) {
    sum.low += sent.low * weight, sum.high += sent.high * weight;
    return;
  }
  const Rgb t = unpack_tint(hit.tint()) * weight;
  sum.low += sent.low * Float8{t.x, t.y, t.z, t.x, t.y, t.z, t.x, t.y};
  sum.high += sent.high * Float8{t.z, t.x, t.y, t.z, t.x, t.y, t.z, 0};
}

/// Adds `weight` times the bilinear lookup at a hit, whose own weights are renormalised over the
/// texels that have an element.
[[gnu::always_inline]] inline void add_lookup(const BlockMap& m, const StoredHit& hit, float weight,
                                              Lanes& sum) {
  constexpr float kUnit = 1.0f / float(StoredHit::kSteps);
  const float fx = float(hit.fx()) * kUnit, fy = float(hit.fy()) * kUnit;
  const BlockTexel* upper = m.texels.data() + hit.base();
  const BlockTexel* lower = upper + m.stride;
  const std::array<const BlockTexel*, 4> texel{upper, upper + 1, lower, lower + 1};
  const std::array<float, 4> part{(1 - fx) * (1 - fy), fx * (1 - fy), (1 - fx) * fy, fx * fy};
  Lanes sent;
  for (size_t k = 0; k < 4; ++k) {
    Float8 a, b;
    load8(texel[k]->value.data(), a), load8(texel[k]->value.data() + 8, b);
    sent.low += a * part[k], sent.high += b * part[k];
  }
  // Coverage is zero only where all texels around the hit are hidden.
  const float coverage = sent.high[kCoverage - 8];
  if (coverage > 0) add(hit, weight / coverage, sent, sum);
}

[[gnu::always_inline]] inline const BlockTexel& nearest(const BlockMap& m, const StoredHit& hit) {
  const uint32_t right = 2 * hit.fx() >= StoredHit::kSteps,
                 down = 2 * hit.fy() >= StoredHit::kSteps;
  return m.texels[hit.base() + right + down * m.stride];
}

/// Adds the lookup at the nearest texel alone, where that has an element: a quarter of the memory
/// is read, which is what sparse sweeps, whose hits lie far apart, take their time for.
[[gnu::always_inline]] inline void add_nearest(const BlockMap& m, const StoredHit& hit,
                                               float weight, Lanes& sum) {
  const BlockTexel& texel = nearest(m, hit);
  if (!(texel.value[kCoverage] > 0)) return add_lookup(m, hit, weight, sum);
  Lanes sent;
  load8(texel.value.data(), sent.low), load8(texel.value.data() + 8, sent.high);
  add(hit, weight, sent, sum);
}

/// B = rho E + tau E behind, as bounces.cpp has it.
void fill_radiosity(BlockMap& m, const atlas::TexelMap& map, const transport::Elements& elements,
                    const TracedHits& hits, std::span<const StoredHit> behind,
                    const LightOfLayers& light, const Block& block) {
  const auto irradiance = [&](size_t i, size_t l) {
    return light.of(i, block.first, block.count)[l];
  };
  const auto reflected = [&](size_t i, size_t l) {
    return elements.reflectance[i] * irradiance(i, l);
  };
  if (behind.empty()) return fill(m, map, hits, block, reflected);
  BlockMap all = empty_map(map.resolution);
  fill(all, map, hits, block, irradiance);
  fill(m, map, hits, block, [&](size_t i, size_t l) {
    if (max_component(elements.transmittance[i]) <= 0) return reflected(i, l);
    Lanes other;
    add_lookup(all, behind[i], 1, other);
    std::array<float, kLanes> e;
    store8(other.low, e.data()), store8(other.high, e.data() + 8);
    return reflected(i, l) + elements.transmittance[i] * Rgb{e[3 * l], e[3 * l + 1], e[3 * l + 2]};
  });
}

struct LayerSweep {
  const BlockMap& radiosity;
  LightOfLayers source, light;
  Block block;
  size_t stride = 1;
  const SubsampledHits* subsampled = nullptr;  ///< of that stride; null: there are none
};

/// Gives an element the light of what its rays have gathered.
[[gnu::always_inline]] inline void update(const LayerSweep& sweep, const TracedHits& hits,
                                          size_t element, const Lanes& sum) {
  std::array<float, kLanes> e;
  store8(sum.low, e.data()), store8(sum.high, e.data() + 8);
  const float inverse = 1.0f / float(hits.samples[element]);
  const Block& block = sweep.block;
  const std::span<const Rgb> source = sweep.source.of(element, block.first, block.count);
  const std::span<Rgb> light = sweep.light.of(element, block.first, block.count);
  for (size_t l = 0; l < light.size(); ++l)
    light[l] = source[l] + Rgb{e[3 * l], e[3 * l + 1], e[3 * l + 2]} * inverse;
}

LUXEL_VECTOR_CLONES
void sweep_layers_of_tile(const LayerSweep& sweep, const TracedHits& hits, const TileHits& tile,
                          size_t first_element) {
  const size_t end = std::min(first_element + kTileElements, hits.size());
  for (size_t i = first_element; i < end; ++i) {
    Lanes sum;
    for (size_t r = hits.first_round[i]; r <= hits.last_round[i]; ++r) {
      const std::span<const StoredHit> own = tile.of(r, i - first_element);
      for (const StoredHit& hit : own) add_lookup(sweep.radiosity, hit, 1, sum);
    }
    update(sweep, hits, i, sum);
  }
}

LUXEL_VECTOR_CLONES
void sweep_layers_sparsely(const LayerSweep& sweep, const TracedHits& hits, const TileHits& tile,
                           size_t first_element) {
  const size_t end = std::min(first_element + kTileElements, hits.size());
  for (size_t i = first_element; i < end; ++i) {
    Lanes sum;
    for_each_sparse(hits, tile, i, sweep.stride, [&](const StoredHit& hit, float weight) {
      add_nearest(sweep.radiosity, hit, weight, sum);
    });
    update(sweep, hits, i, sum);
  }
}

/// Sweeps a tile of the copy, which gives the bits of sweep_layers_sparsely().
LUXEL_VECTOR_CLONES
void sweep_subsampled(const LayerSweep& sweep, const TracedHits& hits,
                      const SubsampledHits::Tile& tile, size_t first_element) {
  uint32_t hit = 0;
  for (size_t k = 0; k < tile.end.size(); ++k) {
    Lanes sum;
    for (; hit < tile.end[k]; ++hit) {
      if (hit + kAhead < tile.hits.size())
        __builtin_prefetch(&nearest(sweep.radiosity, tile.hits[hit + kAhead]));
      add_nearest(sweep.radiosity, tile.hits[hit], tile.weight[hit], sum);
    }
    update(sweep, hits, first_element + k, sum);
  }
}

/// A sweep over the hits that are here. Errors: the file of hits cannot be read, cancelled.
Status sweep_own(const LayerSweep& sweep, const TracedHits& hits, Progress& progress) {
  if (!sweep.subsampled)
    return for_each_tile(hits, progress, [&](size_t t, const TileHits& tile) {
      const auto sweep_one = sweep.stride > 1 ? sweep_layers_sparsely : sweep_layers_of_tile;
      sweep_one(sweep, hits, tile, t * kTileElements);
    });
  LUXEL_CHECK(sweep.subsampled->stride == sweep.stride);
  return for_each_tile(*sweep.subsampled, progress,
                       [&](size_t t, const SubsampledHits::Tile& tile) {
                         sweep_subsampled(sweep, hits, tile, t * kTileElements);
                       });
}

/// Gives all members of a team what each has swept. Errors: those of exchange().
Status give_swept(const LayerSweep& sweep, const TracedHits& hits, Progress& progress) {
  const auto for_each = [&](size_t t, const auto& visit) {
    const size_t begin = t * kTileElements, end = std::min(begin + kTileElements, hits.size());
    for (size_t i = begin; i < end; ++i)
      visit(sweep.light.of(i, sweep.block.first, sweep.block.count));
  };
  return exchange(hits.team, own_tiles(hits),
                  {hits.owner.size(),
                   [&](size_t t, ByteWriter& out) {
                     for_each(t, [&](std::span<Rgb> light) { out.put(std::as_bytes(light)); });
                   },
                   [&](size_t t, uint32_t, ByteReader& in) {
                     for_each(t,
                              [&](std::span<Rgb> light) { in.get(std::as_writable_bytes(light)); });
                     return in.ok;
                   }},
                  progress);
}

/// Errors: the file of hits cannot be read, cancelled, another member of the team gives up.
Status run_layer_sweep(const LayerSweep& sweep, const TracedHits& hits, Progress& progress) {
  LUXEL_TRY_STATUS(sweep_own(sweep, hits, progress));
  return hits.team ? give_swept(sweep, hits, progress) : Status();
}

/// Gives each layer its share of the whole. Returns the sum of squares of what was missing.
double share_out(std::span<const Rgb> whole, const LightOfLayers& light) {
  constexpr size_t kElementsPerSum = 4096;
  std::vector<double> missing2((whole.size() + kElementsPerSum - 1) / kElementsPerSum);
  parallel_for(whole.size(), kElementsPerSum, [&](size_t begin, size_t end) {
    double sum2 = 0;
    for (size_t i = begin; i < end; ++i) {
      const Rgb missing = light::share_out(whole[i], light.of(i, 0, light.layers));
      sum2 += double(dot(missing, missing));
    }
    missing2[begin / kElementsPerSum] = sum2;
  });
  return std::accumulate(missing2.begin(), missing2.end(), 0.0);
}

/// Sparse sweeps when all bounces are asked for. Each takes a layer's share closer to what it ends
/// at by the reflectance, at least: how large the whole is is known from the start.
constexpr size_t kSparseSweeps = 10;

/// The strides of all sweeps but the last. A given number of bounces has as many sweeps.
std::vector<size_t> sparse_strides(int bounces, const TracedHits& hits) {
  const size_t fewest = hits.samples.empty() ? 0 : *std::ranges::min_element(hits.samples);
  const size_t sparsest = sparsest_stride(fewest), middle = std::min(sparsest, kStrides[1]);
  if (bounces >= 0) return std::vector<size_t>(size_t(std::max(bounces - 1, 0)), middle);
  std::vector<size_t> strides(kSparseSweeps, sparsest);
  strides.push_back(middle);
  return strides;
}

std::vector<std::vector<Rgb>> layer_by_layer(const LightOfLayers& light, size_t elements) {
  std::vector<std::vector<Rgb>> out(light.layers, std::vector<Rgb>(elements));
  parallel_for(elements, 4096, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i)
      for (size_t l = 0; l < light.layers; ++l) out[l][i] = light.of(i, l, 1)[0];
  });
  return out;
}

}  // namespace

std::vector<Rgb> layer_sources(const TracedHits& hits, std::vector<Rgb> direct) {
  LUXEL_CHECK(direct.size() == hits.sky_by_layer.size() && hits.size() > 0);
  const size_t layers = direct.size() / hits.size();
  parallel_for(hits.size(), 4096, [&](size_t begin, size_t end) {
    for (size_t k = begin * layers; k < end * layers; ++k)
      direct[k] += hits.sky_by_layer[k] * (kPi / float(hits.samples[k / layers]));
  });
  return direct;
}

Result<LayersBounced> bounce_layers(const atlas::TexelMap& map, const transport::Elements& elements,
                                    const TracedHits& hits, std::span<const StoredHit> behind,
                                    LayeredLight given, const LayerBounceParams& params,
                                    Progress& progress) {
  const size_t n = elements.size();
  std::vector<Rgb>& source = given.source;
  const std::span<const Rgb> whole = given.whole;
  LUXEL_CHECK(n > 0 && source.size() % n == 0 && whole.size() == n);
  const size_t layers = source.size() / n;
  const int bounces = params.bounces;
  std::vector<Rgb> solution = source;
  const LightOfLayers light{solution, layers}, sources{source, layers};
  BlockMap radiosity = empty_map(map.resolution);
  std::optional<SubsampledHits> subsampled;
  const std::vector<size_t> sparse = sparse_strides(bounces, hits);
  progress.begin("layers", 0);
  if (std::ranges::count(sparse, kSparsest) > 1) {
    LUXEL_TRY(subsampled, subsample(hits, kSparsest, params.spare_bytes, progress));
  }
  const auto sweep_all = [&](size_t stride) -> Status {
    if (stride != kSparsest) subsampled.reset();
    for (Block block; block.first < layers; block.first += kLayerBlock) {
      block.count = std::min(kLayerBlock, layers - block.first);
      fill_radiosity(radiosity, map, elements, hits, behind, light, block);
      const LayerSweep sweep{radiosity, sources, light,
                             block,     stride,  subsampled ? &*subsampled : nullptr};
      LUXEL_TRY_STATUS(run_layer_sweep(sweep, hits, progress));
    }
    progress.advance(1);
    return {};
  };
  // Sharing out leaves, of a guess's errors and a sparse solution's noise, only those of the share.
  size_t before = SIZE_MAX;
  for (const size_t stride : sparse) {
    if (bounces < 0 && before > stride) share_out(whole, light);
    LUXEL_TRY_STATUS(sweep_all(stride));
    before = stride;
  }
  if (bounces < 0) share_out(whole, light);
  if (bounces != 0) LUXEL_TRY_STATUS(sweep_all(1));
  const double missing2 = share_out(whole, light), mean = mean_luminance(whole);
  return LayersBounced{layer_by_layer(light, n),
                       mean > 0 ? std::sqrt(missing2 / (3 * double(n))) / mean : 0};
}

}  // namespace luxel::gather
