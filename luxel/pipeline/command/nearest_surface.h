// The point of a scene's surfaces that is nearest to a place.
#pragma once

#include <optional>

#include "luxel/scene/scene.h"

namespace luxel::pipeline {

struct NearestSurface {
  scene::SurfacePoint point;
  Vec3 position{};                    ///< on the smooth surface
  Vec3 start{};                       ///< where rays start there, on the side that is meant
  Vec3 normal{}, geometric_normal{};  ///< of that side; unit
  float distance_m = INFINITY;        ///< infinite: there is none
};

/// Surfaces that `facing` is given for count only where their normal is within 45 degrees of it.
/// The side is the front, or, of a surface that reflects from behind, the one that faces there, or
/// else `at`. A point on an edge is moved a hair into its triangle.
NearestSurface nearest_surface(const scene::Scene& scene, Vec3 at, std::optional<Vec3> facing);

}  // namespace luxel::pipeline
