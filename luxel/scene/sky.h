// A clear sky and its sun, computed from the air. [Hillaire20; docs/method/lights.md]
#pragma once

#include "luxel/base/vec.h"
#include "luxel/scene/environment.h"

namespace luxel::scene {

/// Half the angle under which the sun is seen from the earth.
inline constexpr float kSunAngularRadiusRad = 0.00465f;
/// E of a surface that faces the sun above the air, at the mean distance [lx] [IES84: 127.5 klx].
inline constexpr double kSunLux = 127500;

/// Where the sun stands, how hazy the air is, how fine the picture is.
struct SkyParams {
  Vec3 towards_sun{0, 1, 0};   ///< unit, +Y is up; may lie below the horizon
  double turbidity = 2;        ///< 1 (air alone) to 10 (thick haze): atmosphere_of()
  double sun_distance_au = 1;  ///< its light changes with the inverse square
  int height = 256;            ///< of the picture, even; it is twice as wide
};

/// The light of a clear day.
struct Sky {
  /// Linear sRGB [cd/m^2], without the sun's disc, not turned. The lower half is the ground:
  /// diffuse, albedo 0.3, lit by this sun and sky, the same everywhere.
  Environment radiance;
  /// E of a surface that faces the sun [lx], for a light whose disc has kSunAngularRadiusRad; zero
  /// when all of the disc is below the horizon.
  Rgb sun_illuminance{};
  Vec3 towards_sun{};
};

/// The sky over a plain at sea level. The same bits for any number of threads.
Sky make_sky(const SkyParams& params);

}  // namespace luxel::scene
