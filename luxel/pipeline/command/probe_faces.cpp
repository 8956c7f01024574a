// `luxel probe --solver hierarchical`: light of every face in closed form.
#include "luxel/pipeline/command/probe.h"

#include <algorithm>

#include "luxel/base/clock.h"
#include "luxel/base/deadline.h"
#include "luxel/base/file.h"
#include "luxel/base/output_folder.h"
#include "luxel/base/parallel.h"
#include "luxel/display/contact_sheet.h"
#include "luxel/import/import.h"
#include "luxel/pipeline/solver/hierarchical.h"
#include "luxel/scene/origin.h"
#include "luxel/solve/hierarchical/represent.h"
#include "luxel/solve/hierarchical/surface.h"

namespace luxel::pipeline {
namespace {

constexpr size_t kMostTiles = 12;
constexpr int kTile = 240, kMargin = 12;

/// Just inside of its face: on an edge irradiance is the limit from there.
DVec3 inwards(const hierarchical::Face& face, DVec3 place) {
  return place + (viewfactor::mean_corner(face.corners) - place) * 1e-5;
}

bool contains(viewfactor::PolygonView polygon, DVec3 normal, DVec3 p) {
  return hierarchical::depth_inside(polygon, normal, p) >= 0;
}

/// The source's plane from the point's side: what is seen white, what is hidden violet.
image::Image8 draw_backprojection(const hierarchical::Solution& solution,
                                  const hierarchical::Receiver& at, uint32_t face) {
  image::Image8 tile{kTile, kTile, 3, std::vector<uint8_t>(size_t(kTile) * kTile * 3, 32)};
  const hierarchical::Backprojection back = hierarchical::backproject(solution, at, face);
  const hierarchical::FacePlane plane = hierarchical::plane_coordinates(solution.faces.faces[face]);
  double size = 0;
  for (const DVec3& p : solution.faces.faces[face].corners)
    size = std::max({size, std::abs(plane.to_plane(p).x), std::abs(plane.to_plane(p).y)});
  const DVec3 normal = solution.faces.faces[face].plane.normal;
  const double side = solution.faces.faces[face].plane.height(at.position) < 0 ? -1 : 1;
  const double scale = size / (kTile / 2 - kMargin);
  for (int y = 0; y < kTile; ++y)
    for (int x = 0; x < kTile; ++x) {
      const DVec3 p =
          plane.from_plane({(x - kTile / 2 + 0.5) * scale, (kTile / 2 - 0.5 - y) * scale});
      std::array<uint8_t, 3> color{32, 32, 32};
      if (contains(solution.faces.faces[face].corners, normal, p)) color = {70, 70, 70};
      if (contains(back.source, normal * side, p)) color = {110, 60, 150};
      for (const viewfactor::Polygon& part : back.visible)
        if (contains(part, normal * side, p)) color = {255, 255, 255};
      std::copy(color.begin(), color.end(), tile.data.begin() + (y * kTile + x) * 3);
    }
  return tile;
}

Status write_picture(const ProbeSettings& s, const hierarchical::Solution& solution,
                     const scene::Scene& scene, const hierarchical::Receiver& at,
                     std::span<const hierarchical::Seen> seen) {
  std::vector<display::Tile> tiles;
  for (size_t k = 0; k < std::min(seen.size(), kMostTiles); ++k) {
    const hierarchical::Face& face = solution.faces.faces[seen[k].face];
    tiles.push_back({fmt::format("{} {:.1f} %", name_of(scene, face.instance),
                                 100 * seen[k].visible / seen[k].whole),
                     draw_backprojection(solution, at, seen[k].face)});
  }
  if (tiles.empty())
    return fail(ErrorCode::bad_input,
                "{}: no surface is visible from there, so there is no picture", s.output.string());
  return write_file_atomically(s.output, image::encode_png(display::contact_sheet(tiles)));
}

/// Share of the remaining time in which paths find the error of the faces' light.
constexpr double kPathsShare = 0.25;
constexpr int kMostPathRounds = 10;

/// probe_by_faces() but for its error, which ends at the end of --time-budget; only refinement and
/// feedback look at the clock. `scene`: becomes what is read.
Result<Probed> probe_by_solution(const ProbeSettings& s, Clock::time_point start,
                                 scene::Scene& scene, Progress& progress) {
  // Scene and solution.
  progress.begin("import", 0);
  Probed out;
  LUXEL_TRY(scene, read_probe_scene(s, out));
  LUXEL_TRY(const trace::RayTracer tracer, trace::RayTracer::build(scene));
  LUXEL_TRY(hierarchical::Solution solution,
            hierarchical::solve(scene, tracer, s.hierarchical.solve, progress));
  out.warnings.insert(out.warnings.end(), solution.warnings.begin(), solution.warnings.end());
  // The surface that is meant.
  std::optional<DVec3> normal;
  if (s.normal) normal = normalize(to_double(*s.normal));
  const hierarchical::FacePoint nearest =
      hierarchical::nearest_face_point(solution.faces, s.at - scene.origin, normal);
  const double diagonal_m = double(solution.diagonal_m);
  const double distance_m = nearest.face == hierarchical::kNone
                                ? double(INFINITY)
                                : length(nearest.position - (s.at - scene.origin));
  if (!(distance_m <= kFarFromSurfaces * diagonal_m))
    return Failure{far_from_surfaces(s, diagonal_m, distance_m)};
  const hierarchical::Face& face = solution.faces.faces[nearest.face];
  const hierarchical::Receiver at = hierarchical::receiver_at(solution, scene, tracer, nearest.face,
                                                              inwards(face, nearest.position));
  // Its E: exact, and as the mesh of light interpolates it.
  hierarchical::RepresentParams represent;
  represent.seconds = (1 - kPathsShare) * (s.time_budget_s - seconds_since(start));
  hierarchical::LeftOut left_out;
  LUXEL_TRY(const hierarchical::LightMesh mesh,
            hierarchical::represent(solution, scene, tracer, s.hierarchical.mesh, represent,
                                    progress, &left_out));
  if (left_out.refinement || left_out.feedback)
    out.warnings.push_back(about_left_out(left_out, s.time_budget_s));
  LUXEL_TRY(const std::vector<Rgb> exact,
            hierarchical::irradiance_at(solution, scene, tracer, {&at, 1}, {1e-6}, progress));
  if (const auto p = hierarchical::locate(solution, mesh, nearest.face, nearest.position))
    out.interpolated = hierarchical::value_of(mesh.interpolant[p->triangle], p->s, p->t);
  out.irradiance = out.punctual_and_background = exact[0];
  LUXEL_TRY_STATUS(check_held(scene, to_float(nearest.position), out));
  if (!(max_component(exact[0]) > 0)) out.warnings.push_back(no_light_arrives("the point"));
  out.name = name_of(scene, face.instance), out.material = scene.materials[face.material].name;
  out.position = nearest.position + scene.origin, out.normal = to_float(at.normal);
  out.distance_m = float(distance_m);
  // The sources, and what is left of E without them.
  const std::vector<hierarchical::Seen> seen =
      hierarchical::sources_at(solution, tracer, at, {1e-6});
  for (const hierarchical::Seen& f : seen) {
    const hierarchical::Face& source = solution.faces.faces[f.face];
    out.sources.push_back({name_of(scene, source.instance), scene.materials[source.material].name,
                           f.visible, f.visible / f.whole, f.irradiance});
    out.punctual_and_background = max(Rgb{}, out.punctual_and_background - f.irradiance);
  }
  progress.begin(kWriteStage, 0);
  if (!s.output.empty()) LUXEL_TRY_STATUS(write_picture(s, solution, scene, at, seen));
  return out;
}

/// Closed forms of radiosities that err: only something else can say by how much. The difference to
/// paths from the place holds their noise, too, so that it is an upper limit in the mean.
Status set_error(const ProbeSettings& s, double seconds, const scene::Scene& scene, Probed& out,
                 Progress& progress) {
  ProbeSettings paths = s;
  paths.at = out.position, paths.normal = out.normal;
  paths.max_error = ProbeSettings().max_error, paths.most_rounds = kMostPathRounds;
  paths.time_budget_s = seconds;
  progress.begin("check", 0);
  LUXEL_TRY(const Probed judge, probe_by_paths(paths, scene, {}, progress));
  const Rgb off = out.irradiance - judge.irradiance;
  const Rgb noise = judge.standard_error;
  out.standard_error = {std::hypot(off.x, noise.x), std::hypot(off.y, noise.y),
                        std::hypot(off.z, noise.z)};
  out.luminance_error =
      std::hypot(luminance(out.irradiance) - luminance(judge.irradiance), judge.luminance_error);
  return {};
}

}  // namespace

Result<Probed> probe_by_faces(const ProbeSettings& s, Progress& progress) {
  const Clock::time_point start = Clock::now();
  scene::Scene scene;
  std::optional<Deadline> deadline(std::in_place, progress, s.time_budget_s);
  Result<Probed> out = probe_by_solution(s, start, scene, progress);
  const bool is_late = deadline->passed();
  deadline.reset();
  if (out)
    LUXEL_TRY_STATUS(set_error(s, s.time_budget_s - seconds_since(start), scene, *out, progress));
  if (!out && out.error().code == ErrorCode::cancelled && is_late)
    return fail(ErrorCode::out_of_time,
                "--time-budget {:g} ran out in the stage '{}' before --solver hierarchical had a "
                "result; give more time or a larger --eps, or leave out --solver",
                s.time_budget_s, progress.snapshot().stage);
  return out;
}

}  // namespace luxel::pipeline
