// The light around a scene in two layers: a soft one, which rays find by themselves, and its
// bright texels, above all a sun in a map, which are aimed at.
//
//   L = min(L, limit) + (L - limit)+
//
// Rays with the density of the cosine gather the first with little noise, whatever the scene, and
// the second has few pixels, which samples in proportion to their power hit all the time. Both
// layers are estimated without bias and nothing has to be weighted. [docs/method/lights.md]
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "luxel/base/both_directions.h"
#include "luxel/base/random.h"
#include "luxel/scene/scene.h"

namespace luxel::light {

struct Surroundings {
  Rgb background{};        ///< radiance of rays that leave the scene, besides that of the map
  float limit = INFINITY;  ///< luminance of the map [W/(sr m^2)] at which bright texels begin
  std::vector<uint32_t>
      bright_texels;  ///< pixels of the map that rise above the limit, in Morton order
  /// Power of all bright texels before each one, the integral of their luminance [W/m^2]; one extra
  /// entry, the power of all.
  std::vector<double> below;
  /// Per part of the power, of as many as there are bright texels, the bright texel in which it
  /// begins, or one before it.
  std::vector<uint32_t> guide;
  /// Cosine of the angle from up where each row of the map begins; one extra entry, its end.
  std::vector<double> row_cosine;
};

/// Finds the bright texels of the scene's map. The limit is kBrightTexel times the mean luminance
/// of what lies below it.
Surroundings surroundings_of(const scene::Scene& scene);

/// Radiance of the soft layer, background included.
Rgb soft_radiance(const scene::Scene& scene, const Surroundings& s, Vec3 direction);
/// Soft radiance of many directions, which takes less time: their pixels lie far apart in memory,
/// and are waited for at the same time.
void soft_radiance(const scene::Scene& scene, const Surroundings& s,
                   std::span<const Vec3> directions, std::vector<Rgb>& out);

/// A direction towards a bright texel. Zero power: there is none, do not ask.
struct BrightTexelSample {
  Vec3 direction;
  Rgb radiance_over_pdf;  ///< (L - limit)+ / density: its mean is the integral of the bright texels
};
/// u in [0, 1)^2, of a sequence that spreads evenly.
BrightTexelSample sample_bright_texels(const scene::Scene& scene, const Surroundings& s, Vec2 u);

using both::folded_cosine;
using both::mirrored_above;

}  // namespace luxel::light
