// How far a relighter's light is from the truth.
#pragma once

#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/solve/matrix/relight.h"
#include "luxel/transport/elements.h"

namespace luxel::pipeline {

/// Places spread evenly over a scene's surfaces, where light is checked.
transport::Elements places_to_check(const scene::Scene& scene, uint64_t seed);

/// Data whose target holds other places, too, behind its own.
struct CheckedTarget {
  matrix::Target target;
  size_t own = 0;  ///< places before those that are checked
};
CheckedTarget with_places(matrix::Target target, const transport::Elements& places);

/// Sets data.baked_error and data.lamp_error, and takes the checked places out of the target. They
/// are bounds of the root mean square of the error of indirect light over its mean, by luminance:
/// of the scene's own lights, and of point lights, from the largest of a few; 0 where there is no
/// such light. Light of the path tracer, twice and independent, is the truth: with a and b, (g -
/// a)(g - b) has the mean of the square of g's error. Errors: cancelled; triangles that cannot be
/// traced.
Status measure_relight_error(const scene::Scene& scene, const trace::RayTracer& tracer,
                             size_t own_places, uint64_t seed, matrix::RelightData& data,
                             Progress& progress);

}  // namespace luxel::pipeline
