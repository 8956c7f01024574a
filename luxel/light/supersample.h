// Direct light averaged over texels inside which it varies.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "luxel/atlas/footprint.h"
#include "luxel/base/bytes_per_entry.h"
#include "luxel/light/direct_light.h"
#include "luxel/light/texel_scene.h"

namespace luxel::light {

/// The samples of a scene's texels.
inline LitElements lit_elements(const TexelScene& in) {
  return {in.scene, in.elements, in.lights, in.tracer, in.light_device};
}

struct SupersampleParams {
  int points = 16;         ///< per texel where light varies; 1: none
  float threshold = 0.1f;  ///< neighbours that differ by more of the brighter one make it vary
  /// Settings of direct_light, without sky_samples. Each point gets an eighth of the samples, but
  /// eight at least where that many are asked for.
  DirectParams direct = {};
};

struct Supersampled {
  std::vector<uint32_t> texels;  ///< that were averaged over, in the order of the map
  uint64_t rays = 0;
};

/// Sampling levels of each element's direct light.
struct DirectLevels {
  std::vector<uint8_t> level;     ///< per element: shadow rays, or points, times 4 to this power
  std::vector<uint8_t> averaged;  ///< per element: 1 where it is a mean over points of its texel
};
inline constexpr uint64_t kLevelBytesPerElement =
    bytes_per_entry(&DirectLevels::level, &DirectLevels::averaged);

/// The points of texels at which light is averaged, without those inside of solids and those beyond
/// walls that stand on the texel (luxel/transport/own_side.h). A texel whose
/// own sample lies inside a solid has that alone: it is hidden, and refilled from its neighbours.
struct Footprints {
  std::vector<uint32_t> first;  ///< per texel, one extra entry
  transport::Elements points;   ///< without reflectance
};
/// Footprints of all texels of the map, as the judge wants them; `in.lights` is not looked at. 16
/// points need 576 bytes a texel. Errors: cancelled.
Result<Footprints> footprints(const TexelScene& in, int points, uint64_t seed, Progress& progress);

/// Replaces the direct light of uneven texels, and of those at a chart's border or in the light of
/// a punctual light where it differs between points of the texel, by its mean over `points` points
/// of their footprint, and its variance by an estimate for that mean; all others, and hidden ones,
/// keep their bits.
/// Errors: cancelled; those of in.light_device, as of the other two.
Result<Supersampled> supersample(const TexelScene& in, const SupersampleParams& params,
                                 DirectLight& direct, Progress& progress);

/// Supersamples such texels that are in `among`, which is in the order of the map.
Result<Supersampled> supersample(const TexelScene& in, std::span<const uint32_t> among,
                                 const SupersampleParams& params, DirectLight& direct,
                                 Progress& progress);

/// Averages the direct light of the texels `which` over their points, uneven or not.
Result<Supersampled> average_texels(const TexelScene& in, std::span<const uint32_t> which,
                                    const SupersampleParams& params, DirectLight& direct,
                                    Progress& progress);

}  // namespace luxel::light
