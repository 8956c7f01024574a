#include "luxel/solve/gather/budget/repeat_check.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "luxel/base/random.h"
#include "luxel/solve/gather/bounce/sweep.h"
#include "luxel/solve/gather/budget/adaptive.h"
#include "luxel/solve/gather/trace/trace_hits.h"

namespace luxel::gather {
namespace {

/// One element in so many is chosen, within bounds: the first for a ratio that is good enough, the
/// other since more would tell little.
constexpr size_t kElementsPerChosen = 32, kFewestChosen = 512, kMostChosen = 2048;
/// Any number: it sets these random numbers apart from those of the light.
constexpr uint64_t kRepeatSeed = 0x4e9ea7;

/// How likely each element is chosen, times the number of those that are. Half of it is as its
/// variance is due, which tells most where that is right; the other half is the same for all, for
/// what rays have missed nobody believes.
struct Chances {
  double all = 0, count = 0;  ///< the sum of variances, and the number of elements; of visible ones

  double of(float variance) const { return 0.5 * double(variance) / all + 0.5 / count; }
};
Chances chances_of(std::span<const float> variance, const TracedHits& hits) {
  Chances out;
  for (size_t i = 0; i < variance.size(); ++i)
    if (!is_hidden(hits, i)) out.all += double(variance[i]), out.count += 1;
  return out;
}

/// Elements by equal steps along the sum of all chances (systematic sampling); ascending.
std::vector<uint32_t> choose_elements(std::span<const float> variance, const TracedHits& hits,
                                      const Chances& chances, uint64_t seed) {
  std::vector<uint32_t> out;
  if (!(chances.all > 0)) return out;
  const size_t count = std::clamp(variance.size() / kElementsPerChosen, kFewestChosen, kMostChosen);
  double sum = 0;
  const double first = double(unit_float(uint32_t(hash64(seed, kRepeatSeed))));
  for (uint32_t i = 0; i < variance.size(); ++i) {
    if (is_hidden(hits, i)) continue;
    sum += chances.of(variance[i]) * double(count);
    while (out.size() < count && double(out.size()) + first < sum) out.push_back(i);
  }
  return out;
}

/// Elements of their own, with no repeats.
struct Chosen {
  std::vector<uint32_t> elements;
  atlas::TexelMap map;
  transport::Elements places;
};
Chosen chosen_of(const light::TexelScene& in, std::span<const uint32_t> drawn) {
  Chosen out;
  std::ranges::unique_copy(drawn, std::back_inserter(out.elements));
  out.map.resolution = in.map.resolution;
  out.map.texel_at.assign(in.map.texel_at.size(), atlas::kNone);
  for (const uint32_t i : out.elements) {
    const atlas::Texel& texel = in.map.texels[i];
    out.map.texel_at[size_t(texel.y) * size_t(in.map.resolution) + size_t(texel.x)] =
        uint32_t(out.map.texels.size());
    out.map.texels.push_back(texel);
  }
  out.places = transport::elements_from_texels(in.scene, in.atlas, out.map);
  return out;
}

/// Their direct light, each as fine as it was. Errors: cancelled.
Result<light::DirectLight> direct_again(const light::TexelScene& of_chosen,
                                        const light::DirectLevels& levels,
                                        std::span<const uint32_t> elements,
                                        const light::SupersampleParams& params,
                                        Progress& progress) {
  LUXEL_TRY(light::DirectLight out,
            light::direct_light(light::lit_elements(of_chosen), params.direct, progress));
  int finest = 0;
  for (const uint32_t i : elements) finest = std::max(finest, int(levels.level[i]));
  for (int level = 0; level <= finest; ++level) {
    ByLook which;
    for (uint32_t k = 0; k < elements.size(); ++k) {
      const uint32_t i = elements[k];
      if (levels.level[i] != level) continue;
      if (levels.averaged[i])
        which.averaged.push_back(k);
      else if (level > 0)  // that of the others is there
        which.single.push_back(k);
    }
    LUXEL_TRY_STATUS(look_at_level(of_chosen, which, level, params, out, progress));
  }
  return out;
}

/// E of elements that gather from a map, given their direct light. Errors: cancelled.
Result<std::vector<Rgb>> gather_from(const RadiosityMap& m, const TracedHits& hits,
                                     std::span<const Rgb> direct, std::span<const uint8_t> only,
                                     Progress& progress) {
  std::vector<Rgb> out(hits.size());
  std::vector<float> variance(hits.size()), split(hits.size());
  Sweep sweep{.direct = direct,
              .irradiance = out,
              .variance = variance,
              .split_variance = split,
              .only = only};
  LUXEL_TRY_STATUS(run_sweep(m, hits, sweep, progress));
  return out;
}

/// Makes rays follow the guide where those of the light do.
void follow_same_guide(const TracedHits& of_light, std::span<const uint32_t> elements,
                       TracedHits& hits) {
  if (of_light.guide.of_element.empty()) return;
  hits.guide.groups = of_light.guide.groups;
  for (const uint32_t i : elements) hits.guide.of_element.push_back(of_light.guide.of_element[i]);
  for (size_t k = 0; k < elements.size(); ++k)
    if (is_guided(of_light, elements[k])) begin_guided(hits, k, of_light.guided[elements[k]]);
}

/// What elements are lit by.
struct Repeated {
  const light::TexelScene& of_chosen;
  const transport::OwnSides& sides;
  const LightToRepeat& light;
  const RepeatParams& params;
  std::span<const uint32_t> elements;
  const RadiosityMap& sent;
};

struct LightAgain {
  std::vector<Rgb> direct, irradiance;  ///< E per chosen element [W/m^2]
};

/// E of the chosen elements with other random numbers: direct light as fine as it was, and as many
/// rays each. Errors: cancelled, disk full.
Result<LightAgain> light_again(const Repeated& in, Progress& progress) {
  light::SupersampleParams direct = in.params.direct;
  direct.direct.seed = hash64(direct.direct.seed, kRepeatSeed);
  direct.direct.parts = nullptr, direct.direct.layers = nullptr;
  LUXEL_TRY(light::DirectLight again,
            direct_again(in.of_chosen, in.light.levels, in.elements, direct, progress));
  std::vector<uint16_t> samples;
  for (const uint32_t i : in.elements) samples.push_back(in.light.hits.samples[i]);
  TracedHits hits = no_hits(samples.size());
  follow_same_guide(in.light.hits, in.elements, hits);
  LUXEL_TRY_STATUS(trace_more(trace_scene(in.of_chosen, &in.sides), samples,
                              {.seed = direct.direct.seed,
                               .memory_limit_bytes = in.params.memory_limit_bytes,
                               .scratch_folder = in.params.scratch_folder,
                               .follows_near = in.params.follows_near,
                               .team = direct.direct.team},
                              hits, progress));
  LUXEL_TRY(std::vector<Rgb> e, gather_from(in.sent, hits, again.irradiance, {}, progress));
  return LightAgain{std::move(again.irradiance), std::move(e)};
}

}  // namespace

Result<TrueNoise> noise_by_repeating(const light::TexelScene& in, const transport::OwnSides& sides,
                                     const LightToRepeat& light, const RepeatParams& params,
                                     Progress& progress) {
  // 1. Elements, some of them more than once.
  const Chances chances = chances_of(light.noise_variance, light.hits);
  const std::vector<uint32_t> drawn =
      choose_elements(light.noise_variance, light.hits, chances, params.direct.direct.seed);
  if (drawn.empty()) return TrueNoise{};
  const Chosen chosen = chosen_of(in, drawn);
  // 2. Their light as it is, and anew. Both gather from one map.
  RadiosityMap sent = empty_radiosity_map(in.map.resolution);
  fill_radiosity(sent, in.map, in.elements, light.hits, light.behind, light.irradiance);
  std::vector<uint8_t> is_chosen(light.hits.size());
  for (const uint32_t i : chosen.elements) is_chosen[i] = 1;
  LUXEL_TRY(const std::vector<Rgb> known,
            gather_from(sent, light.hits, light.direct.irradiance, is_chosen, progress));
  const light::TexelScene of_chosen{in.scene,  in.atlas,  chosen.map,     chosen.places,
                                    in.lights, in.tracer, in.light_device};
  const Repeated repeated{of_chosen, sides, light, params, chosen.elements, sent};
  LUXEL_TRY(const LightAgain again, light_again(repeated, progress));
  // 3. The sums of all variances, as those say that were chosen.
  double sum = 0, of_direct = 0, of_both = 0;
  size_t k = 0;
  for (const uint32_t i : drawn) {
    while (chosen.elements[k] != i) ++k;
    const double direct = double(luminance(light.direct.irradiance[i] - again.direct[k])),
                 rest = double(luminance(known[i] - again.irradiance[k])) - direct;
    const double weight = 0.5 / chances.of(light.noise_variance[i]);
    sum += (direct + rest) * (direct + rest) * weight, of_direct += direct * direct * weight;
    of_both += (direct * direct + rest * rest) * weight;
  }
  return TrueNoise{.over_believed = sum / double(drawn.size()) / chances.all,
                   .share_of_direct = of_both > 0 ? of_direct / of_both : 0};
}

}  // namespace luxel::gather
