// The answer: irradiance at every point of the mesh.
#pragma once

#include "luxel/solve/hemicube/receivers.h"

namespace luxel::hemicube {

/// Linear over each triangle when there is light per vertex; constant when it is per triangle.
struct Field {
  Mesh mesh;
  Receivers receivers;
  std::vector<Rgb> irradiance;  ///< E per element [W/m^2]
};

/// E at a surface point of the scene that the mesh was made from [W/m^2].
Rgb irradiance_at(const Field& field, const scene::SurfacePoint& p);

/// Light per vertex from light per triangle: the mean of the triangles around each, by their areas.
/// Those inside solids and covered ones (flags per triangle) are left out; nothing else around: 0.
Field smoothed(const scene::Scene& scene, const Field& per_triangle,
               std::span<const uint8_t> enclosed, std::span<const uint8_t> covered);

}  // namespace luxel::hemicube
