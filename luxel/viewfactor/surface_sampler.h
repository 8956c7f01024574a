// Points spread uniformly over the front of a surface, with a direction each.
#pragma once

#include <cstdint>
#include <vector>

#include "luxel/scene/facet.h"

namespace luxel::viewfactor {

/// The triangles of an instance, to be chosen by area.
struct SurfaceSampler {
  std::vector<scene::Facet> triangles;
  std::vector<double> area_below;  ///< before each triangle; one extra entry
};
SurfaceSampler make_surface_sampler(const scene::Scene& scene, uint32_t instance);

struct SurfaceSample {
  Vec3 position;  ///< just off the surface (scene::off_surface)
  Vec3 normal;    ///< of the front
};
/// Uniform in area for uniform u.
SurfaceSample sample_surface(const SurfaceSampler& sampler, Vec2 u);

/// A place in [0, 1)^4: two points of the two-dimensional Sobol sequence, the second one with its
/// index shuffled, so that the pairs are independent while each keeps its strata. Indices below
/// 2^24.
struct FourNumbers {
  Vec2 first, second;
};
FourNumbers stratified_4d(uint32_t index, uint64_t seed);

}  // namespace luxel::viewfactor
