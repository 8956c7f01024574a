// Some elements that stand for all, where the error of all is measured.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "luxel/light/supersample.h"
#include "luxel/light/texel_scene.h"

namespace luxel::light {

using IsHidden = std::function<bool(size_t element)>;

/// The chance that each element is chosen, times the number of those that are. Half of it is as its
/// variance is due, which tells most where that is right; the other half is the same for all, for
/// what rays have missed nobody believes.
struct Chances {
  double all = 0, count = 0;  ///< the sum of variances, and the number of elements; of visible ones

  double of(float variance) const {
    return all > 0 ? 0.5 * double(variance) / all + 0.5 / count : 1 / count;
  }
};
Chances chances_of(std::span<const float> variance, const IsHidden& is_hidden);

/// `count` visible elements by equal steps along the sum of all chances (systematic sampling);
/// ascending, some more than once. None where all are hidden.
std::vector<uint32_t> choose_elements(std::span<const float> variance, const IsHidden& is_hidden,
                                      const Chances& chances, size_t count, uint64_t seed);

/// Chosen elements as a map of their own, with no repeats.
struct Chosen {
  std::vector<uint32_t> elements;
  atlas::TexelMap map;
  transport::Elements places;
};
Chosen chosen_of(const TexelScene& in, std::span<const uint32_t> drawn);
inline TexelScene scene_of(const TexelScene& in, const Chosen& chosen) {
  return {in.scene, in.atlas, chosen.map, chosen.places, in.lights, in.tracer, in.light_device};
}

/// The light of some elements by two answers that share no random number, with each other or with
/// the light that they judge.
struct Answers {
  std::vector<uint32_t> elements;  ///< ascending
  std::vector<double> weight;      ///< the mean over all visible elements is the sum of these parts
  std::vector<Rgb> first, second;  ///< E [W/m^2]
};
/// Elements and weights of answers that are still to be given.
Answers answers_for(std::span<const uint32_t> drawn, std::span<const float> variance,
                    const Chances& chances);

/// A mean of squares, and its standard error.
struct MeanSquare {
  double mean = 0, standard_error = 0;
};
/// The mean square error of the luminance of E, one per element of all: for light g and answers a
/// and b the mean of (g - a)(g - b) is the square of g's error, and the answers' noise drops out.
MeanSquare square_error(const Answers& answers, std::span<const Rgb> irradiance);

/// E straight from lights, of all elements: averaged over their points, or with one point at their
/// samples. Errors: cancelled.
Result<std::vector<Rgb>> direct_anew(const TexelScene& in, const SupersampleParams& params,
                                     Progress& progress);

}  // namespace luxel::light
