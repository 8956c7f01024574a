// The distribution of a light's intensity over directions: measured far-field photometry.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "luxel/base/vec.h"

namespace luxel::scene {

struct Scene;

/// Candela on a grid of two angles, bilinear in between. A light is measured in a frame of its own:
/// -z is its aim (the nadir of a light that hangs), x the side of horizontal angle 0, as
/// EXT_lights_ies has it.
struct LightProfile {
  /// The goniometer's angles [LM63, Types A, B, C], v vertical and h horizontal:
  ///   c: planes through z turned by h, v from the aim: (sin v cos h, sin v sin h, -cos v)
  ///   b: planes through y turned by v, h out of them:  (cos h sin v, -sin h, -cos h cos v)
  ///   a: planes through x turned by h, v out of them:  (sin v, -cos v sin h, -cos v cos h)
  enum class Angles : uint8_t { c, b, a };
  std::string name;  ///< the file's
  Angles angles = Angles::c;
  std::vector<float> vertical_rad;    ///< ascending, two or more
  std::vector<float> horizontal_rad;  ///< ascending; c: {0}, the same all round, or 0 to 2 pi
  std::vector<float> candela;         ///< [horizontal][vertical], >= 0
};

/// I [cd] in a unit `direction` that leaves the light; `aim` and `side` are the light's -z and x in
/// the world, orthonormal. Beyond the angles of the grid a light is dark.
float candela_at(const LightProfile& profile, Vec3 aim, Vec3 side, Vec3 direction);

/// Mean of I over the directions within `half_angle_rad` of the aim, by 512 x 512 directions; over
/// pi it is the flux [lm] / (4 pi).
double mean_candela(const LightProfile& profile, double half_angle_rad);

/// Gives a point or spot light of the scene this distribution: the largest channel of its intensity
/// becomes `scale` (black becomes white), a factor on the profile's candela. Its direction and side
/// become orthonormal.
void attach_profile(Scene& scene, size_t light, LightProfile profile, float scale);

}  // namespace luxel::scene
