// Facts that must hold in scenes of our own: darkness behind thin walls, light beneath leaves.
// Tests hold bakes to them, `luxel bench scenes` prints them.
#pragma once

#include "luxel/pipeline/bake/bake_scene.h"
#include "luxel/validate/agreement.h"

namespace luxel::validate {

/// Light inside of closed_corner's house, where there is none, and on the lawn around it: luminance
/// of E [W/m^2].
struct HouseLight {
  float texel = 0;   ///< the brightest texel inside
  float lookup = 0;  ///< the brightest bilinear lookup at places inside, as a player sees them
  int lookups = 0;
  double lawn = 0;  ///< mean over the lawn outside
};
/// Reads a bake of closed_corner.
HouseLight house_light(const pipeline::Bake& bake);

/// Gather against the path tracer on foliage's floor.
struct FoliageLight {
  Agreement floor;
  size_t texels = 0, in_shadow = 0;
  /// Mean light over the judge's: of all texels, and of those with less than 0.4 of the brightest.
  double mean = 0, shadow_mean = 0;
  bool is_two_sided = false;  ///< twigs, and nothing else, have two sides
};
/// 160 x 160 texels, 1024 rays, 256 shadow rays against twice `paths`. Errors: those of
/// solver and judge, cancelled.
Result<FoliageLight> foliage_light(int paths, Progress& progress);

}  // namespace luxel::validate
