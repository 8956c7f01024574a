// Hierarchical radiosity: elements as large as the error of their links allows. [Hanrahan91;
// Hardt96, chapter 4]
#pragma once

#include <optional>

#include "luxel/solve/hierarchical/refine.h"
#include "luxel/solve/hierarchical/unlinked_lights.h"

namespace luxel::hierarchical {

/// Precision of the solution, and its limits.
struct SolveParams {
  /// The error that a link may have [W/m^2]; nothing: a hundredth of the mean irradiance. No less
  /// than a ten-thousandth of that mean, whatever is asked for.
  std::optional<double> eps;
  double min_area_m2 = 0;  ///< elements are not divided below this; 0: the scene's area / 2^18
  size_t max_elements = 1u << 20, max_links = 1u << 25;
  int bounces = -1;  ///< reflections; < 0: all. Counted, `shining` is what has been reflected
                     ///< one time less than `irradiance`: what points gather
  double tolerance = 1e-4;  ///< of the iteration, relative to the mean
  Basis basis = Basis::linear;
};

/// The solution. Parts refer to each other by index, and it can be moved.
struct Solution {
  Faces faces;
  Tree tree;
  Light light;
  Links links;
  Blockers blockers;
  UnlinkedLights unlinked;
  double eps = 0, min_area_m2 = 0;
  std::vector<std::string> warnings;  ///< overlaps.h; a bound that ended the refinement
  int iterations = 0;                 ///< refinements
  int sweeps = 0;                     ///< gathers
  float diagonal_m = 0;
  double unit_area_m2 = 1;
  bool all_bounces = true;
  /// The light is made in gaps that faces as a whole would cover: nothing counts as covered
  /// (transport::size_for_covers).
  bool light_in_gaps = false;
  Basis basis = Basis::linear;

  /// The data that links are made from. It refers to this solution.
  Exchange exchange(const trace::RayTracer& tracer) const {
    return {faces, tree, blockers, tracer, unit_area_m2, basis, light_in_gaps};
  }
};

/// Links, gathers until the light settles, and refines the links by the light there is, again and
/// again until none errs by more than eps. What punctual lights and the background send
/// arrives at leaves straight away. Errors: cancelled.
Result<Solution> solve(const scene::Scene& scene, const trace::RayTracer& tracer,
                       const SolveParams& params, Progress& progress);

/// A solution between two iterations of solve().
struct Iterated {
  Solution solution;
  std::vector<float> off;  ///< what light_leaves() keeps
};
/// Begins as solve() does: links everything to everything by a guess of the light, as coarsely as
/// ten times the usual eps allows, and gathers until the light settles. Errors: cancelled.
Result<Iterated> begin_iterating(const scene::Scene& scene, const trace::RayTracer& tracer,
                                 const SolveParams& params, Progress& progress);
/// One of its iterations: refines the links by the light there is, and gathers until the light
/// settles. True: no link errs by more than eps, and nothing was refined. `params` may change from
/// one to the next; `bounces` is not looked at. Errors: cancelled; the solution is then of no use.
Result<bool> iterate_once(Iterated& iterated, const scene::Scene& scene,
                          const trace::RayTracer& tracer, const SolveParams& params,
                          Progress& progress);

/// Jacobi's iteration with the links there are, until a sweep changes less than `tolerance` of the
/// mean. Errors: cancelled.
Status iterate(Solution& solution, const trace::RayTracer& tracer, double tolerance,
               Progress& progress);

/// Area-weighted means over all faces [W/m^2], and their area.
struct Totals {
  double area_m2 = 0;
  Rgb irradiance, radiosity, emission;
};
/// The means over all faces of a solution.
Totals totals_of(const Solution& solution);
/// Luminance that all leaves absorb over what they emit: 1 where nothing gets out.
double absorbed_over_emitted(const Solution& solution);

}  // namespace luxel::hierarchical
