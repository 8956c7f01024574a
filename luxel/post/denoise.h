// Takes the noise of sampling out of irradiance without touching what is light.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string_view>
#include <vector>

#include "luxel/atlas/atlas.h"
#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/base/team.h"
#include "luxel/scene/scene.h"

namespace luxel::post {

/// Where the texels of a map lie; spans have one entry per texel.
struct TexelGeometry {
  const scene::Scene& scene;
  const atlas::Atlas& atlas;
  const atlas::TexelMap& map;
  std::span<const Vec3> position;   ///< world [m]
  std::span<const Vec3> normal;     ///< unit shading normal
  std::span<const uint8_t> hidden;  ///< 1: its light means nothing; neither read nor changed
  /// Texels with different numbers share no light. Empty: all may.
  std::span<const uint32_t> region = {};
};

/// The reach of the filter, and the differences up to which it takes light for the same.
struct DenoiseParams {
  float radius = 9;                    ///< largest distance of a neighbour, in texels
  float max_normal_angle_rad = 0.35f;  ///< neighbours that face farther apart share no light
  /// Two texels count as the same light up to so many standard deviations of their difference.
  float max_deviations = 2.5f;
};

/// Samples texels again, more finely: a value for each.
using LookAgain = std::function<Result<std::vector<Rgb>>(std::span<const uint32_t> texels)>;

/// A part of the light, one value per texel [any unit], and the estimated variance of its luminance
/// [unit^2]: an upper bound, which is lowered to what neighbours show.
struct NoisyLight {
  std::span<Rgb> values;
  std::span<const float> variance;
  /// Direct light: a single bright texel may be a spot's circle. What looks like a firefly is
  /// looked at again, and lowered to what is seen then; without `look_again` it stays.
  bool is_direct = false;
  LookAgain look_again = {};
};

/// The filter that this build has: "luxel", or "oidn" where Open Image Denoise was found.
std::string_view denoiser_name();

/// Filters each part by itself. A texel becomes the value at its own place of a plane fitted to the
/// texels around it on the same surface, on whichever charts they lie; windows grow in steps, and a
/// neighbour counts for as long as its estimate agrees with that plane to within what their
/// variances explain (propagation and separation [Polzehl00, Polzehl06]; docs/method/denoise.md).
/// Fireflies (luxel/post/outliers.h) are shared out among their neighbours first. The sum of values
/// stays. Texels without variance around them keep their values bit for bit. Values stay finite and
/// non-negative. The same bits for any number of threads, and of members of a team, who share the
/// texels out. Errors: cancelled; those of look_again; another member of the team gives up.
Status denoise(const TexelGeometry& places, std::span<const NoisyLight> parts,
               const DenoiseParams& params, Progress& progress, Team* team = nullptr);

}  // namespace luxel::post
