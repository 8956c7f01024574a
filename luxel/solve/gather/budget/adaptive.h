// The errors of the texels' light, and the texels that need more rays.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "luxel/atlas/atlas.h"
#include "luxel/light/supersample.h"
#include "luxel/light/texel_scene.h"
#include "luxel/solve/gather/bounce/bounces.h"

namespace luxel::gather {

/// Two estimates of the variance of each element's luminance [(W/m^2)^2]: as if its rays were
/// independent, which is steady but too large, because they are stratified; and the squared
/// difference of its halves, nearly right in the mean, but a single square.
struct VariancePair {
  std::span<const float> independent, split;
};

/// Stratification gains about as much for neighbours: the first estimate, or its mean over the
/// neighbours of the same chart if that is larger, times the ratio of both, summed over them; if
/// `among` names some elements, those of them that are `among` too, for the others have fewer
/// samples. docs/method/gather.md
std::vector<float> pooled_variances(const atlas::Atlas& atlas, const atlas::TexelMap& map,
                                    VariancePair variance, std::span<const uint32_t> among = {});

/// A tenth of the mean luminance: relative errors of what is darker are told over it.
float darkest_light(std::span<const Rgb> irradiance);

/// Per element, its standard error over its own luminance, or over a tenth of the mean luminance
/// where it is darker: what nobody sees is not worth the rays. Hidden elements have none.
std::vector<float> relative_errors(std::span<const float> variance, std::span<const Rgb> irradiance,
                                   const TracedHits& hits);

/// Standard errors of stratified samples fall like n^-kDecay and a bit faster
/// (docs/method/gather.md): it says how many samples more are needed.
inline constexpr float kDecay = 0.7f;

/// The standard error that the light from lights, or the rest, may have: with half of the square
/// each, 95 of 100 elements err by less than max_error.
inline float error_of_part(float max_error) { return max_error * (0.70710678f / 1.96f); }

/// Samples of the next round: of elements whose relative error is larger than max_error two or four
/// times as many as they have, of others what they have. More than max_samples nobody gets.
std::vector<uint16_t> next_samples(std::span<const float> errors, float max_error, int max_samples,
                                   std::span<const uint16_t> samples);

/// Samples that each round will add, until error_p95 of `all` errors is below max_error. Assumes
/// that errors of the gathered light, which are part of `all`, fall like n^-kDecay, and that lights
/// are looked at until their errors are small enough.
std::vector<uint64_t> rounds_to_come(std::span<const float> all, std::span<const float> gathered,
                                     float max_error, int max_samples,
                                     std::span<const uint16_t> samples);

/// Samples of all elements.
uint64_t sum_of(std::span<const uint16_t> samples);

/// Takes samples back from `target` until no more than `affordable` are added to `samples`: they go
/// first to where they lower the sum of squared errors most for a ray.
void keep_affordable(std::span<const float> errors, uint64_t affordable,
                     std::span<const uint16_t> samples, std::vector<uint16_t>& target);

/// Per element, 1 where its error is larger than max_error.
std::vector<uint8_t> elements_above(std::span<const float> errors, float max_error);

/// True: the direct light of an element can be looked at one level finer.
bool can_be_finer(const light::DirectLevels& levels, size_t element);

/// Elements whose direct light is that of their own sample, and those that have a mean over points.
struct ByLook {
  std::vector<uint32_t> single, averaged;
};
/// The direct light of elements as a level has it: `params` with 4^level times the shadow rays of
/// single ones, and the points of the others. Errors: cancelled.
Status look_at_level(const light::TexelScene& in, const ByLook& which, int level,
                     const light::SupersampleParams& params, light::DirectLight& direct,
                     Progress& progress);

/// Looks at the direct light of elements that are chosen, 1, again, one level finer. Returns how
/// many there were: 0 when none is chosen that is not as fine as it can be. Errors: cancelled.
Result<size_t> refine_direct(const light::TexelScene& in, std::span<const uint8_t> chosen,
                             const light::SupersampleParams& params, light::DirectLevels& levels,
                             light::DirectLight& direct, Progress& progress);

/// The smallest max_error, `at_least` or larger, with which refine_direct would trace about `rays`
/// rays at most.
float affordable_error(std::span<const float> errors, float at_least, double rays,
                       const light::SupersampleParams& params, const light::DirectLevels& levels);

}  // namespace luxel::gather
