#include "luxel/solve/gather/budget/repeat_check.h"

#include <algorithm>
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
/// Answers have so many times the rays of the light that they judge, and so many at least, at most:
/// then their noise is below that of light which the denoiser has made a few times less noisy.
constexpr int kAnswerTimes = 4, kFewestAnswerRays = 1024, kMostAnswerRays = 16384;
/// And so many times its shadow rays, for its penumbrae are a few texels.
constexpr int kAnswerShadowTimes = 16;
/// Answers' rays are this part of the light's at most, but for the fewest elements.
constexpr double kAnswerPart = 1.0 / 50;
constexpr size_t kFewestAnswers = 128, kMostAnswers = 512;
/// Any number: it sets these random numbers apart from those of the light.
constexpr uint64_t kRepeatSeed = 0x4e9ea7, kAnswerSeed = 0xa45e4;

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

/// Elements that are lit once more, and the scene and light for it.
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

/// E of the chosen elements by so many rays each, which no one has traced before, given their
/// direct light. Errors: cancelled, disk full.
Result<std::vector<Rgb>> gather_again(const Repeated& in, std::span<const Rgb> direct,
                                      std::span<const uint16_t> samples, uint64_t seed,
                                      Progress& progress) {
  TracedHits hits = no_hits(samples.size());
  follow_same_guide(in.light.hits, in.elements, hits);
  LUXEL_TRY_STATUS(trace_more(trace_scene(in.of_chosen, &in.sides), samples,
                              {.seed = seed,
                               .memory_limit_bytes = in.params.memory_limit_bytes,
                               .scratch_folder = in.params.scratch_folder,
                               .follows_near = in.params.follows_near,
                               .team = in.params.direct.direct.team},
                              hits, progress));
  return gather_from(in.sent, hits, direct, {}, progress);
}

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
  LUXEL_TRY(std::vector<Rgb> e,
            gather_again(in, again.irradiance, samples, direct.direct.seed, progress));
  return LightAgain{std::move(again.irradiance), std::move(e)};
}

}  // namespace

Result<TrueNoise> noise_by_repeating(const light::TexelScene& in, const transport::OwnSides& sides,
                                     const LightToRepeat& light, const RepeatParams& params,
                                     Progress& progress) {
  // 1. Elements, some of them more than once.
  const auto hidden = [&](size_t i) { return is_hidden(light.hits, i); };
  const light::Chances chances = light::chances_of(light.noise_variance, hidden);
  if (!(chances.all > 0)) return TrueNoise{};
  const size_t count =
      std::clamp(light.hits.size() / kElementsPerChosen, kFewestChosen, kMostChosen);
  const std::vector<uint32_t> drawn = light::choose_elements(light.noise_variance, hidden, chances,
                                                             count, params.direct.direct.seed);
  const light::Chosen chosen = light::chosen_of(in, drawn);
  // 2. Their light as it is, and anew. Both gather from one map.
  RadiosityMap sent = empty_radiosity_map(in.map.resolution);
  fill_radiosity(sent, in.map, in.elements, light.hits, light.behind, light.irradiance);
  std::vector<uint8_t> is_chosen(light.hits.size());
  for (const uint32_t i : chosen.elements) is_chosen[i] = 1;
  LUXEL_TRY(const std::vector<Rgb> known,
            gather_from(sent, light.hits, light.direct.irradiance, is_chosen, progress));
  const light::TexelScene of_chosen = light::scene_of(in, chosen);
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

Result<light::Answers> answers_by_repeating(const light::TexelScene& in,
                                            const transport::OwnSides& sides,
                                            const LightToRepeat& light,
                                            std::span<const uint8_t> enclosed,
                                            const RepeatParams& params, Progress& progress) {
  const auto hidden = [&](size_t i) { return enclosed[i] != 0; };
  const auto rays_of_answer = [&](size_t i) {
    return uint16_t(
        std::clamp(kAnswerTimes * int(light.hits.samples[i]), kFewestAnswerRays, kMostAnswerRays));
  };
  const light::Chances chances = light::chances_of(light.noise_variance, hidden);
  if (chances.count == 0) return light::Answers{};
  double rays = 0, rays_of_answers = 0;  // of all elements
  for (size_t i = 0; i < light.hits.size(); ++i)
    if (!hidden(i)) rays += light.hits.samples[i], rays_of_answers += 2 * rays_of_answer(i);
  const double part = kAnswerPart * rays / rays_of_answers;
  const size_t count = std::clamp(size_t(part * chances.count), kFewestAnswers, kMostAnswers);
  const std::vector<uint32_t> drawn = light::choose_elements(light.noise_variance, hidden, chances,
                                                             count, params.direct.direct.seed);
  light::Answers out = light::answers_for(drawn, light.noise_variance, chances);
  const light::Chosen chosen = light::chosen_of(in, drawn);
  RadiosityMap sent = empty_radiosity_map(in.map.resolution);
  fill_radiosity(sent, in.map, in.elements, light.hits, light.behind, light.irradiance);
  const light::TexelScene of_chosen = light::scene_of(in, chosen);
  const Repeated repeated{of_chosen, sides, light, params, chosen.elements, sent};
  std::vector<uint16_t> samples;
  for (const uint32_t i : chosen.elements) samples.push_back(rays_of_answer(i));
  light::SupersampleParams again = params.direct;
  again.direct.samples *= kAnswerShadowTimes;
  again.direct.parts = nullptr, again.direct.layers = nullptr;
  for (std::vector<Rgb>* answer : {&out.first, &out.second}) {
    again.direct.seed = hash64(params.direct.direct.seed, kAnswerSeed + (answer == &out.second));
    LUXEL_TRY(const std::vector<Rgb> direct, light::direct_anew(of_chosen, again, progress));
    LUXEL_TRY(*answer, gather_again(repeated, direct, samples, again.direct.seed, progress));
  }
  return out;
}

}  // namespace luxel::gather
