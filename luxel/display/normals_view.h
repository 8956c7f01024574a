// The normals that local illumination reckons with, drawn as in [Rodriguez06, plate C.8].
#pragma once

#include <vector>

#include "luxel/display/draw.h"
#include "luxel/display/lines.h"

namespace luxel::display {

/// From every corner of a triangle its shading normal as a red line: what draw_normals() draws over
/// surfaces that are seen by this camera.
std::vector<Line> lines_of_normals(const scene::Scene& scene, const scene::Camera& camera);

/// Surfaces in greys (bright where they face the viewer) and from every corner of a triangle its
/// shading normal as a red line, as long as 4 % of the scene's diagonal or as the triangle's
/// longest edge where that is less, hidden behind what stands before it. Corners that share place
/// and normal share a line; of more than 100,000 triangles every n-th has its lines. Colours are
/// what a screen shows, linear in [0, 1]; 4 channels as draw_seen.
Result<image::Image> draw_normals(const scene::Scene& scene, const trace::RayTracer& tracer,
                                  const scene::Camera& camera, const DrawParams& params,
                                  Progress& progress);

}  // namespace luxel::display
