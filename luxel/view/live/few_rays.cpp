#include "luxel/view/live/few_rays.h"

#include <algorithm>

#include "luxel/base/parallel.h"
#include "luxel/light/direct_light.h"
#include "luxel/solve/gather/rays/tile_hits.h"
#include "luxel/solve/gather/trace/trace_hits.h"
#include "luxel/view/live/lamp_light.h"

namespace luxel::view {
namespace {

/// Sweeps end when they change this part of all light, or after so many.
constexpr double kSettled = 5e-4;
constexpr int kMostSweeps = 32;
constexpr int kSmoothings = 2;

/// A texel that a ray has met, with its part in the light of the texel that the ray came from.
struct ReadTexel {
  uint32_t texel = 0;
  Rgb factor{};  ///< of its E, all rays of the element taken together
};

/// Light that chosen texels see.
struct SeenLight {
  std::vector<Rgb> direct, area, sky;  ///< E [W/m^2]; `area` is what of `direct` is not of lamps
  std::vector<uint8_t> hidden;         ///< 1: within a solid
  std::vector<ReadTexel> reads;
  std::vector<uint32_t> end;  ///< of each, one past its last of `reads`
};

/// The nearest texel around the place of a hit; kNone: there is none.
uint32_t nearest_texel(const atlas::TexelMap& map, gather::StoredHit hit) {
  const uint32_t stride = uint32_t(map.resolution) + 2;
  const int x = int(hit.base() % stride) - 1, y = int(hit.base() / stride) - 1;
  const float fx = float(hit.fx()) / gather::StoredHit::kSteps,
              fy = float(hit.fy()) / gather::StoredHit::kSteps;
  uint32_t out = atlas::kNone;
  float most = -1;
  for (int j = 0; j < 2; ++j)
    for (int i = 0; i < 2; ++i) {
      const int column = x + i, row = y + j;
      if (column < 0 || row < 0 || column >= map.resolution || row >= map.resolution) continue;
      const uint32_t texel = map.texel_at[size_t(row) * size_t(map.resolution) + size_t(column)];
      const float weight = (i ? fx : 1 - fx) * (j ? fy : 1 - fy);
      if (texel != atlas::kNone && weight > most) most = weight, out = texel;
    }
  return out;
}

Status read_hits(const KnownLight& known, const SceneState& state, const gather::TracedHits& hits,
                 Progress& progress, SeenLight& out) {
  std::vector<std::vector<ReadTexel>> reads(hits.size());
  LUXEL_TRY_STATUS(
      gather::for_each_tile(hits, progress, [&](size_t tile, const gather::TileHits& of_tile) {
        const size_t first = tile * gather::kTileElements;
        const size_t end = std::min(first + gather::kTileElements, hits.size());
        for (size_t i = first; i < end; ++i)
          for (const gather::StoredHit& hit : of_tile.of(0, i - first)) {
            const uint32_t t = nearest_texel(known.map, hit);
            if (t == atlas::kNone) continue;
            const Rgb rho = scene::reflectance_at(state.scene, known.map.texels[t].sample);
            reads[i].push_back(
                {t, rho * gather::unpack_tint(hit.tint()) * (1 / float(hits.samples[i]))});
          }
      }));
  for (const std::vector<ReadTexel>& of : reads) {
    out.reads.insert(out.reads.end(), of.begin(), of.end());
    out.end.push_back(uint32_t(out.reads.size()));
  }
  return {};
}

/// Direct light of all but lamps. Empty: that is all direct light.
Result<std::vector<Rgb>> area_light(const SceneState& state, const transport::Elements& elements,
                                    const EstimateParams& params) {
  if (state.lights.punctual.empty()) return std::vector<Rgb>();
  Progress own;
  return light::direct_light(state.scene, elements, without_lamps(state.lights), state.tracer,
                             {.samples = params.direct_samples, .seed = params.seed}, own)
      .map([](light::DirectLight direct) { return std::move(direct.irradiance); });
}

Result<SeenLight> look_from(const KnownLight& known, const SceneState& state,
                            const atlas::TexelMap& chosen, const EstimateParams& params) {
  Progress own;  // its stages are not those of the bake
  const transport::Elements elements =
      transport::elements_from_texels(state.scene, known.atlas, chosen);
  SeenLight out;
  LUXEL_TRY(light::DirectLight direct,
            light::direct_light(state.scene, elements, state.lights, state.tracer,
                                {.samples = params.direct_samples, .seed = params.seed}, own));
  out.direct = std::move(direct.irradiance);
  LUXEL_TRY(out.area, area_light(state, elements, params));
  LUXEL_TRY(const gather::TracedHits hits,
            gather::trace_hits({state.scene, known.atlas, elements, state.lights, state.tracer},
                               params.samples, {.seed = params.seed, .layers = nullptr}, own));
  for (size_t i = 0; i < hits.size(); ++i) {
    out.sky.push_back(hits.sky[i] * (kPi / float(hits.samples[i])));
    out.hidden.push_back(gather::is_hidden(hits, i) ? 1 : 0);
  }
  LUXEL_TRY_STATUS(read_hits(known, state, hits, own, out));
  return out;
}

/// Light that arrives at the chosen texels, direct light aside, if texels have `light_of`.
template <class LightOf>
std::vector<Rgb> gathered(const SeenLight& seen, const LightOf& light_of) {
  std::vector<Rgb> out(seen.end.size());
  parallel_for(out.size(), 256, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      out[i] = seen.sky[i];
      for (uint32_t k = i == 0 ? 0 : seen.end[i - 1]; k < seen.end[i]; ++k)
        out[i] += seen.reads[k].factor * light_of(seen.reads[k].texel);
    }
  });
  return out;
}

/// For each cell itself, or one beside it where it lies within a solid: rays do not meet that.
std::vector<uint32_t> cells_outside(std::span<const CellsBeside> beside, const Estimates& e) {
  std::vector<uint32_t> out(beside.size());
  for (uint32_t i = 0; i < out.size(); ++i) {
    const auto is_outside = [&](uint32_t k) { return !e.hidden_before[k] && !e.hidden_after[k]; };
    const auto cells = std::span(beside[i].cells).first(beside[i].count);
    const auto found = std::ranges::find_if(cells, is_outside);
    out[i] = is_outside(i) || found == cells.end() ? i : *found;
  }
  return out;
}

/// All bounces: what surfaces have is what is known, as far as the estimates change it.
void settle(const KnownLight& known, const SpreadTexels& spread,
            std::span<const CellsBeside> beside, const SeenLight& before, const SeenLight& after,
            Estimates& e) {
  const std::vector<uint32_t> outside = cells_outside(beside, e);
  e.reflected_before = gathered(before, [&](uint32_t texel) { return known.irradiance[texel]; });
  e.reflected_after = e.reflected_before;
  for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
    std::vector<Rgb> next = gathered(after, [&](uint32_t texel) {
      const uint32_t k = outside[spread.cell_of_texel()[texel]];
      const Rgb light = e.direct_after[k] + e.reflected_after[k];
      // A black texel has been within a solid, or the light is off.
      if (!(max_component(known.irradiance[texel]) > 0)) return light;
      return scaled(known.irradiance[texel], e.direct_before[k] + e.reflected_before[k], light);
    });
    double change = 0, all = 0;
    for (size_t i = 0; i < next.size(); ++i) {
      change += double(length(next[i] - e.reflected_after[i]));
      all += double(length(e.direct_after[i] + next[i]));
    }
    e.reflected_after = std::move(next);
    if (change <= kSettled * all) break;
  }
}

/// The mean of a cell and of those beside it; what is within solids has that of the others.
std::vector<Rgb> smoothed(std::span<const CellsBeside> beside, std::span<const uint8_t> hidden,
                          std::span<const Rgb> light) {
  std::vector<Rgb> out(light.begin(), light.end());
  for (size_t i = 0; i < out.size(); ++i) {
    Rgb sum{};
    float count = 0;
    for (size_t k = 0; k < beside[i].count; ++k) {
      const uint32_t cell = beside[i].cells[k];
      if (!hidden[cell]) sum += light[cell], count += 1;
    }
    if (count > 0) out[i] = sum / count;
  }
  return out;
}

/// Reflected light changes slowly from place to place: the mean of what is around has less noise.
/// Direct light stays, but for that of cells within solids.
void smooth(std::span<const CellsBeside> beside, Estimates& e) {
  for (int again = 0; again < kSmoothings; ++again) {
    e.reflected_before = smoothed(beside, e.hidden_before, e.reflected_before);
    e.reflected_after = smoothed(beside, e.hidden_after, e.reflected_after);
  }
  const std::vector<Rgb> direct = smoothed(beside, e.hidden_after, e.direct_after);
  const std::vector<Rgb> area = smoothed(beside, e.hidden_after, e.area_after);
  for (size_t i = 0; i < direct.size(); ++i)
    if (e.hidden_after[i]) e.direct_after[i] = direct[i], e.area_after[i] = area[i];
}

}  // namespace

atlas::TexelMap map_of_chosen(const atlas::TexelMap& map, std::span<const uint32_t> chosen) {
  atlas::TexelMap out;
  out.resolution = map.resolution;
  for (const uint32_t t : chosen) out.texels.push_back(map.texels[t]);
  return out;
}

Rgb scaled(Rgb known, Rgb before, Rgb after) {
  const auto channel = [](float k, float b, float a) {
    return a == b ? k : b > 0 && a < kMostFactor * b ? k * (a / b) : a;
  };
  return {channel(known.x, before.x, after.x), channel(known.y, before.y, after.y),
          channel(known.z, before.z, after.z)};
}

Result<Estimates> light_by_few_rays(const KnownLight& known, const SceneState& before,
                                    const SceneState& after, const SpreadTexels& spread,
                                    const EstimateParams& params, const Progress& watched) {
  const atlas::TexelMap chosen = map_of_chosen(known.map, spread.texels());
  LUXEL_TRY(SeenLight was, look_from(known, before, chosen, params));
  LUXEL_TRY_STATUS(stopped(watched));
  LUXEL_TRY(SeenLight is, look_from(known, after, chosen, params));
  LUXEL_TRY_STATUS(stopped(watched));
  Estimates out;
  out.area_before = was.area.empty() ? was.direct : std::move(was.area);
  out.area_after = is.area.empty() ? is.direct : std::move(is.area);
  out.direct_before = std::move(was.direct), out.direct_after = std::move(is.direct);
  out.hidden_before = std::move(was.hidden), out.hidden_after = std::move(is.hidden);
  const std::vector<CellsBeside> beside = spread.beside();
  settle(known, spread, beside, was, is, out);
  smooth(beside, out);
  return out;
}

}  // namespace luxel::view
