// The largest brightness of a scene's light, and errors that name the light beyond it.
#pragma once

#include <functional>
#include <span>
#include <string>

#include "luxel/base/result.h"
#include "luxel/scene/scene.h"

namespace luxel::scene {

/// Radiance of surfaces and surroundings [W/(sr m^2)], and irradiance by one lamp [W/m^2], at most;
/// in nits and lux where lamps are in candela. The sun's disc has 1.6e9 nits.
inline constexpr float kBrightest = 1e15f;
/// Intensity of point and spot lights, profiles included [W/sr], at most; the sun has 2.6e27 cd.
inline constexpr float kMostIntensity = 1e30f;
/// Irradiance by all light together that what follows can hold: noise is measured by sums of its
/// squares, in single precision. A thousand times kBrightest leaves room for all bounces (a
/// reflectance of 0.99 multiplies light by up to 100) and for several lamps.
inline constexpr float kMostIrradiance = 1e18f;

/// Light that can be summed and squared: finite, and at most kMostIrradiance.
inline bool is_held_light(Rgb c) { return is_finite(c) && max_component(c) <= kMostIrradiance; }

/// The largest I of a light [W/sr], with that of its profile; for directional lights E [W/m^2].
/// Infinite where the product overflows.
float brightest_of(const Scene& scene, const PunctualLight& light);

/// Errors: a light, a material, the background or a pixel of the environment that no solver can
/// hold, with its name and value. A point or spot light is too bright when it is so even at the
/// place of the scene's bounds that is farthest from it. `file` is named where it is not empty.
Status check_brightness(const Scene& scene, const std::string& file);

/// The error of light that cannot be held at a place: names what can be brightest there.
Error overflow_at(const Scene& scene, Vec3 place);

/// Errors: overflow_at() the first place whose light cannot be held; `place` says where value i is.
Status check_held(const Scene& scene, std::span<const Rgb> light,
                  const std::function<Vec3(size_t)>& place);

}  // namespace luxel::scene
