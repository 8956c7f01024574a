// Fireflies: single texels that one rare ray has made far brighter than all around them.
#pragma once

#include <span>
#include <vector>

#include "luxel/post/neighbours.h"
#include "luxel/post/noise_level.h"

namespace luxel::post {

/// A part of the light in which fireflies are looked for; spans have one entry per texel.
struct Outliers {
  std::span<const Rgb> values;
  std::span<const float> variance;  ///< that the solver states, of luminance
  const NoiseLevel& noise;          ///< of the same part
  /// Direct light, of which a small bright spot may be one: the texel's own variance must explain
  /// it.
  bool is_direct = false;
};

/// A texel that is too bright, and the luminance that it is to be lowered to.
struct Firefly {
  uint32_t texel = 0;
  float luminance = 0;
};

/// Finds texels with more variance than rounding makes that are brighter than the third brightest
/// (at borders the second) of those within kFireflyRadius (on strips of one texel's width farther)
/// on the same surface, by
///
/// - more than kStandsOut standard deviations of the noise level there, so that the filter would
///   leave them alone, but no more than kExplained deviations that are stated, by the texel itself
///   or in the mean within kShareRadius: light that is known not to be noise is none;
/// - in light that is not direct also by more than kFirefly times, whatever is stated.
///
/// In direct light no more than kExplainedDirect deviations that the texel itself states: these are
/// suspects, a spot that lights a single texel among them. They are to be lowered to that
/// neighbour. In the order of texels. Members of a team share the texels out; null: there is none.
/// Errors: cancelled, another member gives up.
Result<std::vector<Firefly>> find_fireflies(const Neighbourhood& n, const Outliers& part,
                                            Team* team, Progress& progress);
inline constexpr float kFirefly = 2, kFireflyRadius = 2.6f, kFireflyRadiusOfStrips = 4.6f;
inline constexpr float kStandsOut = 3, kExplained = 8, kExplainedDirect = 3;

/// Lowers fireflies, and shares what they lose out evenly among all within kShareRadius that have
/// variance: the sum over texels stays. A firefly is light of a path that few of the texels found
/// though all have it, so that its energy belongs to all of them.
void share_out(const Neighbourhood& n, std::span<const float> variance,
               std::span<const Firefly> fireflies, std::span<Rgb> values);
inline constexpr float kShareRadius = 6;

}  // namespace luxel::post
