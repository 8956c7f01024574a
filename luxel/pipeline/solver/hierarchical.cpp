// Hierarchical radiosity with discontinuity meshing, as a solver of lightmaps.
#include "luxel/pipeline/solver/hierarchical.h"

#include <algorithm>
#include <cmath>

#include "luxel/base/machine_load.h"
#include "luxel/base/parallel.h"
#include "luxel/pipeline/settings/option_rows.h"
#include "luxel/pipeline/solver/measured_error.h"
#include "luxel/pipeline/solver/memory.h"
#include "luxel/pipeline/solver/solver.h"
#include "luxel/pipeline/solver/stage_seconds.h"
#include "luxel/solve/hierarchical/represent.h"
#include "luxel/solve/hierarchical/surface.h"
#include "luxel/transport/back_faces.h"
#include "luxel/transport/covers.h"

namespace luxel::pipeline {
namespace {

/// The side of a square as large as the tree's leaves are on average [m].
float mean_side_m(const hierarchical::Tree& tree) {
  double area = 0, count = 0;
  for (const hierarchical::Element& e : tree.elements)
    if (e.is_leaf()) area += e.area_m2, count += 1;
  return float(std::sqrt(area / std::max(count, 1.0)));
}

/// By which places are covered (transport::open_share).
float cover_size_m(const hierarchical::Solution& solution) {
  return solution.light_in_gaps ? 0 : mean_side_m(solution.tree);
}

Result<TexelLight> solve_hierarchical(const light::TexelScene& in, const BakeSettings& settings,
                                      const SolveStores&, const SolveObserver&,
                                      Progress& progress) {
  LUXEL_TRY_STATUS(memory_to_spare(in, settings, bytes_of_light(in, settings), 0));
  HierarchicalSettings own = settings.own.of<HierarchicalSettings>();
  own.solve.bounces = settings.bounces;
  LUXEL_TRY(hierarchical::Solution solution,
            hierarchical::solve(in.scene, in.tracer, own.solve, progress));
  hierarchical::RepresentParams represent;
  represent.seconds = seconds_left(settings.time_budget_s, progress.stages());
  represent.later_seconds = kMeasuredErrorSeconds * machine_load() / double(thread_count());
  hierarchical::LeftOut left_out;
  LUXEL_TRY(const hierarchical::LightMesh mesh,
            hierarchical::represent(solution, in.scene, in.tracer, own.mesh, represent, progress,
                                    &left_out));
  TexelLight out;
  out.irradiance.resize(in.map.texels.size());
  // Where something much closer than elements covers a texel, they have no light to tell.
  const std::vector<float> open =
      transport::open_shares(in.tracer, in.elements, cover_size_m(solution));
  parallel_for(in.map.texels.size(), 1024, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i)
      out.irradiance[i] =
          hierarchical::irradiance_at(solution, mesh, in.scene, in.map.texels[i].sample) * open[i];
  });
  out.hidden = transport::find_enclosed(in.scene, in.tracer, in.elements);
  out.suspicious_texels = uint64_t(std::count(out.hidden.begin(), out.hidden.end(), 1));
  out.sweeps = solution.sweeps, out.elements = mesh.triangles.size();
  out.warnings = solution.warnings;
  if (left_out.refinement || left_out.feedback)
    out.warnings.push_back(about_left_out(left_out, settings.time_budget_s));
  LUXEL_TRY(out.relative_error,
            measured_error(in, out,
                           {settings.bounces, settings.seed,
                            seconds_left(settings.time_budget_s, progress.stages())},
                           progress));
  return out;
}

}  // namespace

std::string about_left_out(const hierarchical::LeftOut& left_out, double budget_s) {
  return fmt::format(
      "--time-budget {:g} was too short: {} left out; more time, or a larger --eps, gives better "
      "light",
      budget_s,
      left_out.refinement && left_out.feedback ? "refinement and feedback were"
      : left_out.refinement                    ? "refinement was"
                                               : "some of the feedback was");
}

Options<HierarchicalSettings> hierarchical_options() {
  using R = Rows<HierarchicalSettings>;
  return {
      R::number(
          "--eps", [](auto& s) -> auto& { return s.solve.eps; },
          {0, kNoLimit, "is not an error; give W/m^2 >= 0"},
          "Error limit of a link, in W/m^2 on an element of mean size (default: 1 % of the mean "
          "light)")
          .unit("W/M^2"),
      R::number(
          "--min-area", [](auto& s) -> auto& { return s.solve.min_area_m2; },
          {0, kNoLimit, "is not an area; give m^2 >= 0"},
          "Do not subdivide elements below this area in m^2 (default: from the scene)")
          .key_is("min_area_m2")
          .unit("M^2"),
      R::toggle(
          "--no-discontinuities", [](auto& s) -> auto& { return s.mesh.discontinuities; },
          "Do not mesh along shadow edges"),
      R::number(
          "--max-leaf-lines", [](auto& s) -> auto& { return s.mesh.discontinuity.max_per_leaf; },
          {0, 1000}, "Largest number of shadow edges through an element")
          .unit("COUNT"),
      R::number(
          "--min-weight", [](auto& s) -> auto& { return s.mesh.discontinuity.least_weight; },
          {0, kNoLimit, "is not a weight; give W/m^2 per m >= 0"},
          "Leave out shadow edges across which light changes by less than this, in W/m^2 per m, or "
          "in W/m^2 with --ranking nearness (default: from the light in the scene)")
          .unit("WEIGHT"),
      R::choice(
          "--ranking", [](auto& s) -> auto& { return s.mesh.discontinuity.ranking; },
          {{"slope", hierarchical::Ranking::slope}, {"nearness", hierarchical::Ranking::nearness}},
          "How to rank shadow edges: slope (by how much light changes per metre) or nearness (by "
          "how close the blocker is to the surface)"),
  };
}

Solver hierarchical_solver() {
  return {
      .name = "hierarchical",
      .solve = solve_hierarchical,
      .options = options_of_solver("hierarchical", kHierarchicalHeading, hierarchical_options())};
}

}  // namespace luxel::pipeline
