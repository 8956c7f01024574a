// Pictures of the hierarchical solution. [Hardt96, appendix B.3]
#pragma once

#include "luxel/display/quadratic_view.h"
#include "luxel/pipeline/render/techniques.h"
#include "luxel/solve/hierarchical/light_mesh.h"

namespace luxel::pipeline {

/// The mesh of the light as a viewer holds it.
display::QuadraticMesh quadratic_mesh(const scene::Scene& scene,
                                      const hierarchical::Solution& solution,
                                      const hierarchical::LightMesh& mesh);

/// One radiosity per element.
Result<image::Image> draw_flat(const Subject&, const RenderSettings&, Rendered&, Progress&);
/// Exact irradiance at the corners of elements, linear between them.
Result<image::Image> draw_gouraud(const Subject&, const RenderSettings&, Rendered&, Progress&);
/// draw_gouraud() with elements cut along discontinuities.
Result<image::Image> draw_gouraud_disc(const Subject&, const RenderSettings&, Rendered&, Progress&);
/// The interpolants at the middle of each pixel, whose triangles are filled row by row: what a
/// viewer draws.
Result<image::Image> draw_interpolant(const Subject&, const RenderSettings&, Rendered&, Progress&);
/// The interpolants, four rays per pixel, which meet the scene.
Result<image::Image> draw_lerpshade(const Subject&, const RenderSettings&, Rendered&, Progress&);
/// Exact irradiance at every pixel.
Result<image::Image> draw_rayshade(const Subject&, const RenderSettings&, Rendered&, Progress&);

}  // namespace luxel::pipeline
