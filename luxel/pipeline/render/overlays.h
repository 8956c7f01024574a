// Parts of a hierarchical solution (elements, links, ...), as lines over its pictures. [Hardt96,
// appendix B.4]
#pragma once

#include <limits>
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

/// True where any of these shows the light mesh.
bool overlay_needs_mesh(std::span<const std::string> names);

/// Edges of elements, grey: of leaves, and of what is divided at this depth below roots, which are
/// at 0.
std::vector<display::Line> mesh_lines(const hierarchical::Solution& solution,
                                      int depth = std::numeric_limits<int>::max());
/// Links between elements to look at.
struct LinkChoice {
  bool whole = true, partial = true;  ///< nothing, or something, stands between
  size_t most = 300;                  ///< the strongest
};
/// A link between elements: number `number` of its receiver's.
struct StrongLink {
  uint32_t receiver = 0;  ///< an id of the tree
  uint32_t number = 0;
  double power_W = 0;  ///< luminance of what it brings
};
/// Those that bring most light, the first the strongest.
std::vector<StrongLink> strong_links(const hierarchical::Solution& solution,
                                     const trace::RayTracer& tracer, const LinkChoice& choice = {});
/// A line with a head where it ends; short ones have a smaller head.
void add_arrow(DVec3 from, DVec3 to, double head_m, Rgb color, std::vector<display::Line>& out);
inline constexpr double kArrowHead = 0.02;  ///< of links, over the scene's diagonal
/// Arrows from source to receiver, of three lines each, the whole length the first: white where
/// they see each other whole, pink where the plane of one cuts the other, green where something
/// stands between.
std::vector<display::Line> link_lines(const hierarchical::Solution& solution,
                                      std::span<const StrongLink> links);
/// Those on all faces, whatever their weight. Errors: cancelled.
Result<std::vector<hierarchical::Discontinuity>> all_discontinuities(
    const hierarchical::Solution& solution, const scene::Scene& scene,
    const trace::RayTracer& tracer, hierarchical::DiscontinuityParams params, Progress& progress);
/// Violet.
std::vector<display::Line> discontinuity_lines(
    std::span<const hierarchical::Discontinuity> discontinuities);
/// Edges of triangles, violet along discontinuities, else green.
std::vector<display::Line> triangulation_lines(const hierarchical::LightMesh& mesh);
/// Red sticks, the longest a twentieth of the scene's diagonal; `error` as measure_error() gives
/// it.
std::vector<display::Line> error_lines(const hierarchical::Solution& solution,
                                       const hierarchical::LightMesh& mesh,
                                       std::span<const float> error);
/// Yellow sticks of the light at the triangles' corners, the longest a twentieth of the diagonal.
std::vector<display::Line> sample_lines(const hierarchical::Solution& solution,
                                        const hierarchical::LightMesh& mesh);

/// All lines of these names: mesh, links, discontinuities, triangulation, error, which is how far
/// the interpolant of each triangle is off, and samples. Errors: cancelled.
Result<std::vector<display::Line>> overlay_lines(
    std::span<const std::string> names, const hierarchical::Solution& solution,
    const hierarchical::LightMesh& mesh, const scene::Scene& scene, const trace::RayTracer& tracer,
    const hierarchical::MeshParams& params, Progress& progress);

}  // namespace luxel::pipeline
