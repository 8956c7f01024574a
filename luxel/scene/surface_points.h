// Places spread evenly over surfaces.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "luxel/scene/scene.h"

namespace luxel::scene {

/// A choice of surface points or of whole triangles (where `at` means nothing).
using Chosen = std::function<bool(const Scene&, const SurfacePoint&)>;
inline bool everywhere(const Scene&, const SurfacePoint&) { return true; }
Chosen of_material(uint32_t material);

/// `count` points on the chosen triangles, uniform in area: strata of equal area, and inside each
/// triangle a scrambled Sobol sequence, so that the mean of a smooth function over a surface is
/// known much better than from independent points. The same seed gives the same points.
std::vector<SurfacePoint> points_uniform_in_area(const Scene& scene, size_t count, uint64_t seed,
                                                 const Chosen& chosen = everywhere);

}  // namespace luxel::scene
