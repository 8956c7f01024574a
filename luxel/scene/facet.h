// A triangle in the world, for whoever asks several things about its points: each question of
// scene.h places the triangle anew.
#pragma once

#include "luxel/scene/scene.h"

namespace luxel::scene {

struct Facet {
  Triangle3 corners;  ///< world_triangle()
  Vec3 front;         ///< front_normal()
  float size_m = 0;   ///< size_for_rounding(): luxel/scene/off_surface.h
};
Facet facet_of(const Scene& scene, uint32_t instance, uint32_t triangle);

/// shading_normal() of a point whose facet has this front.
Vec3 shading_normal(const Scene& scene, const SurfacePoint& p, Vec3 front);

}  // namespace luxel::scene
