// The path tracer as the judge of a bake, at some of its texels.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "luxel/pipeline/bake/bake_scene.h"

namespace luxel::bench {

/// Up to 2,500 of `count` texels by chance, in order: paths are dear, and the more of them a texel
/// gets the finer a difference it shows.
std::vector<size_t> some_texels(size_t count);

template <class T>
std::vector<T> chosen(std::span<const T> values, std::span<const size_t> texels) {
  std::vector<T> out;
  for (const size_t i : texels) out.push_back(values[i]);
  return out;
}

struct JudgedTexels {
  std::vector<size_t> texels;  ///< numbers in the map
  /// E, twice, from independent points of each texel's footprint and independent paths.
  std::array<std::vector<Rgb>, 2> light;
  std::vector<uint8_t> hidden;  ///< 1: the texel lies inside a solid
};
/// The light of some_texels() of a bake, each time by so many paths. Errors: no memory, cancelled.
Result<JudgedTexels> judge_texels(const pipeline::Bake& bake, int paths_each);

/// The root mean square error of a bake's luminance at those texels, over the mean of their light:
/// the mean of (g - a)(g - b) for the two answers a and b of the judge, whose noise drops out. 0
/// where the noise leaves nothing.
double rmse_over_mean(const pipeline::Bake& bake, const JudgedTexels& judged);

}  // namespace luxel::bench
