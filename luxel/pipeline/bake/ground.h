// The ground under an object in preview.png: its shadow, and nothing else.
#pragma once

#include <optional>

#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/image/image.h"
#include "luxel/scene/scene.h"
#include "luxel/trace/ray_tracer.h"

namespace luxel::pipeline {

/// A level square at the lowest place of a scene. It has the look of the surroundings below the
/// horizon, darker where the scene keeps light away, so that no border of it can be seen.
struct Ground {
  float height_m = 0, half_side_m = 0;
  Vec2 middle;         ///< x and z
  image::Image light;  ///< E over E without the scene, 0 .. 1; rows along z
};

/// The ground that a picture of the scene shows. None where the scene has a floor of its own, where
/// the camera stands within the scene's box, below its lowest place or does not look down, where
/// there are no surroundings, and where the scene has cameras: whoever sets those sets a scene.
/// Errors: cancelled.
Result<std::optional<Ground>> ground_under(const scene::Scene& scene,
                                           const trace::RayTracer& tracer,
                                           const scene::Camera& camera, const Progress& progress);

/// The factor of what a ray sees behind a scene's surfaces; 1 beside the ground.
Rgb light_on(const Ground& ground, const trace::Ray& ray);

}  // namespace luxel::pipeline
