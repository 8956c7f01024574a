// What a hierarchical solution is made of, as lines over its pictures. [Hardt96, appendix B.4]
#pragma once

#include <span>
#include <string>
#include <vector>

#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/display/lines.h"
#include "luxel/solve/hierarchical/represent.h"

namespace luxel::pipeline {

/// "mesh, links, ..."
std::string overlay_names();
/// Names with commas between them. Errors: a name that there is not.
Result<std::vector<std::string>> parse_overlays(std::string_view text);

/// Whether any of these shows the light mesh.
bool overlay_needs_mesh(std::span<const std::string> names);

/// mesh: edges of elements, grey. links: the strongest few hundred, from receiver to source, white
/// where they see each other whole, pink where the plane of one cuts the other, green where
/// something stands between. discontinuities: all of them, whatever their weight, violet.
/// triangulation: edges of triangles, violet along discontinuities, else green. error: how far the
/// interpolant of each triangle is off, as a red stick. samples: yellow sticks of the light at the
/// triangles' corners. The longest stick is a twentieth of the scene's diagonal.
Result<std::vector<display::Line>> overlay_lines(
    std::span<const std::string> names, const hierarchical::Solution& solution,
    const hierarchical::LightMesh& mesh, const scene::Scene& scene, const trace::RayTracer& tracer,
    const hierarchical::MeshParams& params, Progress& progress);

}  // namespace luxel::pipeline
