// A picture of a bake's texels: what they are, not how bright.
#pragma once

#include <span>
#include <vector>

#include "luxel/atlas/atlas.h"
#include "luxel/image/codec.h"

namespace luxel::pipeline {

/// Findings about texels besides their light. Indices into TexelMap::texels; `hidden` and
/// `seam_error` have an entry per texel, or none.
struct TexelFacts {
  std::span<const uint8_t> hidden;
  std::span<const uint32_t> overlapping, moved, refilled;
  std::vector<float> seam_error;  ///< relative difference of a seam's sides
};

/// The pages of the atlas, rows from the top, a colour per texel:
///   a checker of two grays, squares of 8 x 8 texels (density), the chart's border darker;
///   red, the more the two sides of a seam differ: full at 5 %;
///   green: sample moved out of a solid; yellow: inside a solid, refilled from its neighbours;
///   black: inside a solid, where nobody looks; magenta: belongs to more than one chart.
/// Later ones win. Places without a texel are white.
std::vector<image::Image8> draw_texels(const atlas::Atlas& atlas, const atlas::TexelMap& map,
                                       const TexelFacts& facts);

/// The pages of the atlas with the relative standard error of each texel (gather::relative_errors)
/// in false colours, by its logarithm: near black up to kLowestError, pale yellow from
/// kHighestError on.
std::vector<image::Image8> draw_errors(const atlas::Atlas& atlas, const atlas::TexelMap& map,
                                       std::span<const float> errors);
inline constexpr float kLowestError = 0.001f, kHighestError = 0.1f;

}  // namespace luxel::pipeline
