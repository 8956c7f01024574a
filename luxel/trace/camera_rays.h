// From pixels to rays, and from rays to the surfaces that a viewer sees.
#pragma once

#include <span>
#include <vector>

#include "luxel/scene/scene.h"
#include "luxel/trace/ray_tracer.h"

namespace luxel::trace {

/// Half of what a picture of this aspect (width / height) shows from top to bottom: at a distance
/// of 1 m, or for a parallel camera at any [m]. A picture narrower than the camera's own aspect
/// shows the camera's full width.
float half_height(const scene::Camera& camera, float aspect);

/// The rays of a camera for a picture of some size.
struct CameraRays {
  CameraRays(const scene::Camera& camera, int width, int height);

  /// Through picture coordinates, (0, 0) = the top left corner, pixels have size 1. Directions are
  /// of unit length.
  Ray through(float x, float y) const;
  /// The picture coordinates of a place before the eye.
  Vec2 pixel_of(Vec3 place) const;

  Vec3 eye, right, up, forward;  ///< right and up reach the picture's edges at distance 1 [m]
  bool orthographic = false;
  float width = 1, height = 1;
};

/// True where a place lies in the picture and its front turns to the eye, occluded or not.
bool faces(const CameraRays& camera, Vec3 place, Vec3 normal);

/// Surfaces that rays of a picture go through, at most.
inline constexpr int kMostSurfaces = 64;

/// True of the back of a one-sided material, which nobody sees.
bool is_unseen_back(const scene::Scene& scene, const Hit& hit);

/// Lets a ray begin just behind a hit.
void go_on_behind(const Hit& hit, Ray& ray);

/// The first hit of each ray while the back faces of one-sided materials are invisible. A ray goes
/// on behind such a back, through kMostSurfaces at most; `rays` is left where it got to.
std::vector<Hit> visible_hits(const scene::Scene& scene, const RayTracer& tracer,
                              std::span<Ray> rays);

}  // namespace luxel::trace
