// Error of a relighter's light against the truth.
#pragma once

#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/reference/path_tracer.h"
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
/// a)(g - b) has the mean of the square of g's error. Paths are as many as form factors of
/// rays_per_patch are worth: coarse files are checked in less time. Errors: cancelled; triangles
/// that cannot be traced.
Status measure_relight_error(const scene::Scene& scene, const trace::RayTracer& tracer,
                             size_t own_places, int rays_per_patch, uint64_t seed,
                             matrix::RelightData& data, Progress& progress);

/// Light that is compared with the path tracer's.
struct RelitPlaces {
  const scene::Scene& scene;  ///< lit by what the light is of
  const trace::RayTracer& tracer;
  reference::Receivers places;
  std::span<const Rgb> indirect;  ///< E there, but for what comes straight from punctual lights
  int bounces = -1;               ///< that it has; < 0: all
};

/// By how much it is off, by luminance and over the mean of the light.
struct IndirectError {
  double rms = 0;     ///< root mean square, without the noise of the paths; 0: it is less than that
  double p95 = 0;     ///< what 95 of 100 places are off by at most, with the noise of the paths
  double noise = 0;   ///< root mean square of that noise
  size_t places = 0;  ///< that were compared: not those inside of solids
};

/// Twice so many paths from each place tell. Errors: cancelled.
Result<IndirectError> indirect_error(const RelitPlaces& relit, int paths, uint64_t seed,
                                     Progress& progress);
/// The stages of `progress` that it begins, with so many punctual lights: each is as long as the
/// others.
std::vector<Stage> stages_of_indirect_error(size_t lights);

}  // namespace luxel::pipeline
