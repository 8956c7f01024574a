#include "luxel/solve/hierarchical/solve.h"

#include <algorithm>
#include <cmath>

#include "luxel/solve/hierarchical/contacts.h"
#include "luxel/solve/hierarchical/overlaps.h"
#include "luxel/solve/hierarchical/unlinked_lights.h"
#include "luxel/transport/covers.h"

namespace luxel::hierarchical {
namespace {

/// Bounds against endless work. Refinement ends by itself when the light of the last links asks for
/// no more; sweeps converge as reflectance^k, and 0.99^2000 = 2e-9.
constexpr int kMostIterations = 24, kMostSweeps = 2000;
/// The usual eps, as a part of the mean irradiance.
constexpr double kUsualEps = 0.01;
/// The least eps, as a part of the mean irradiance: exact light at points is not known better
/// (PointParams::tolerance), and links would be without end.
constexpr double kLeastEps = 1e-4;
/// The eps of the first links, as a part of the mean emission and the mean direct light of what is
/// no surface. In a closed room both together are less than the mean irradiance. It is ten times
/// the usual eps, because links are only ever divided: what a smaller one would divide in vain,
/// before bounces are known, stays divided. Larger ones cost more iterations.
constexpr double kFirstEps = 0.1;
/// Errors count in full on receivers of a face's mean size, but of no more faces than so many: what
/// is asked for must not depend on how finely a surface is cut into triangles. Where there are more
/// faces, those of mean size are below the unit, and many pairs of them exchange less than eps
/// however near they are: these are guessed.
constexpr size_t kMostUnits = 1024;
/// Elements are not divided below this part of the scene's area: a room of 100 m^2, below 4 cm^2.
constexpr double kSolveLeastPart = 1.0 / (1 << 18);

double area_of(const Tree& tree) {
  double area = 0;
  for (size_t e = 0; e < tree.first_root.back(); ++e) area += tree.elements[e].area_m2;
  return area;
}

double mean_irradiance(const Tree& tree, const Light& light) {
  double sum = 0, area = 0;
  for (size_t e = 0; e < tree.first_root.back(); ++e) {
    sum += tree.elements[e].area_m2 * double(max_component(light.elements[e].irradiance));
    area += tree.elements[e].area_m2;
  }
  return area > 0 ? sum / area : 0;
}

/// Root mean square of the differences of roots and leaves, over the mean.
double change_of(const Tree& tree, const Light& light, std::span<const Rgb> before) {
  double sum = 0, all = 0;
  for (size_t e = 0; e < tree.elements.size(); ++e) {
    if (!tree.elements[e].is_leaf()) continue;
    const Rgb d = light.elements[e].irradiance - before[e];
    sum += tree.elements[e].area_m2 * double(dot(d, d));
    all += tree.elements[e].area_m2 *
           double(dot(light.elements[e].irradiance, light.elements[e].irradiance));
  }
  return all > 0 ? std::sqrt(sum / all) : 0;
}

struct Solving {
  Solution& s;
  const Exchange x;
  std::vector<float>& off;  ///< see light_leaves()
  Refined state;
};

Solving solving_of(Iterated& iterated, const scene::Scene& scene, const trace::RayTracer& tracer) {
  Solution& s = iterated.solution;
  return {s, s.exchange(tracer), iterated.off, {scene, s.tree, s.light, s.links}};
}

double least_area_of(const Solution& s, const SolveParams& params) {
  return params.min_area_m2 > 0 ? params.min_area_m2 : area_of(s.tree) * kSolveLeastPart;
}

/// Light from emission alone, by so many reflections and no more. Points gather what has been
/// reflected one time less than the last gather brings.
void count_bounces(Solving& w, int bounces) {
  std::vector<ElementLight>& light = w.s.light.elements;
  for (ElementLight& l : light) l.received = {}, l.irradiance = {}, l.radiosity = l.emission;
  for (ClusterLight& l : w.s.light.clusters) l.received = {};
  std::vector<std::array<Rgb, 4>> unlinked;  // it is there from the first reflection on
  for (ElementLight& l : light) unlinked.push_back(l.unlinked), l.unlinked = {};
  push_pull(w.s.faces, w.s.tree, w.s.light);
  for (size_t e = 0; e < light.size(); ++e) light[e].unlinked = unlinked[e];
  std::vector<ElementLight> before;
  for (int k = 0; k <= bounces; ++k) {
    if (k == bounces) before = light;
    gather(w.x, w.s.links.of, w.s.light);
    push_pull(w.s.faces, w.s.tree, w.s.light);
  }
  for (size_t e = 0; e < light.size(); ++e)
    light[e].shining = before[e].shining, light[e].most = before[e].most,
    light[e].rough = before[e].rough;
}

RefineParams refine_params(const Solving& w, const SolveParams& params, double eps) {
  return {.eps = eps,
          .min_area_m2 = w.s.min_area_m2,
          .max_elements = params.max_elements,
          .max_links = params.max_links,
          .guesses = w.s.faces.size() > kMostUnits};
}

/// Links everything by a first guess of the light.
Status link_first(Solving& w, const SolveParams& params, Progress& progress) {
  // Elements shine by what they emit.
  for (const Element& e : w.s.tree.elements)
    w.s.light.elements.push_back(bare_light(w.state.scene, w.x, e));
  w.s.light.clusters.resize(w.s.tree.clusters.size());
  push_pull(w.s.faces, w.s.tree, w.s.light);
  w.s.links.of.resize(w.s.tree.size());
  // A first guess, from the light that surfaces emit and that others send them.
  RefineParams refining = refine_params(w, params, INFINITY);
  LUXEL_TRY_STATUS(light_leaves(w.state, w.x, w.s.unlinked, refining, w.off, progress));
  push_pull(w.s.faces, w.s.tree, w.s.light);
  const double first =
      double(max_component(totals_of(w.s).emission)) + mean_irradiance(w.s.tree, w.s.light);
  refining.eps = params.eps ? std::max(*params.eps, kLeastEps * first) : kFirstEps * first;
  w.s.eps = refining.eps;
  LUXEL_TRY_STATUS(light_leaves(w.state, w.x, w.s.unlinked, refining, w.off, progress));
  return link_all(w.state, w.x, refining, progress);
}

/// Adds warnings that a user should read about a solution that is done.
void add_warnings(const SolveParams& params, Solution& s) {
  if (params.eps && *params.eps < s.eps)
    s.warnings.push_back(
        fmt::format("--eps {} is below a ten-thousandth of the mean light; {:.3g} W/m^2 was used",
                    *params.eps, s.eps));
  if (s.links.bounded)
    s.warnings.push_back(
        fmt::format("refinement stopped at {} elements and {} links, before all errors were below "
                    "{:.3g} W/m^2; give a larger --eps or --min-area",
                    s.tree.elements.size(), s.links.count, s.eps));
}

}  // namespace

Status iterate(Solution& s, const trace::RayTracer& tracer, double tolerance, Progress& progress) {
  const Exchange x = s.exchange(tracer);
  std::vector<Rgb> before;
  for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
    LUXEL_TRY_STATUS(stopped(progress));
    before.resize(s.tree.elements.size());
    for (size_t e = 0; e < before.size(); ++e) before[e] = s.light.elements[e].irradiance;
    gather(x, s.links.of, s.light);
    push_pull(s.faces, s.tree, s.light);
    ++s.sweeps;
    if (change_of(s.tree, s.light, before) < tolerance) break;
  }
  return {};
}

Totals totals_of(const Solution& s) {
  Totals out;
  for (size_t e = 0; e < s.tree.first_root.back(); ++e) {
    const auto area = float(s.tree.elements[e].area_m2);
    const ElementLight& l = s.light.elements[e];
    out.area_m2 += s.tree.elements[e].area_m2;
    out.irradiance += l.irradiance * area, out.radiosity += l.radiosity * area;
    out.emission += l.emission * area;
  }
  const float scale = out.area_m2 > 0 ? float(1 / out.area_m2) : 0;
  out.irradiance = out.irradiance * scale, out.radiosity = out.radiosity * scale;
  out.emission = out.emission * scale;
  return out;
}

double absorbed_over_emitted(const Solution& s) {
  double absorbed = 0, emitted = 0;
  for (size_t e = 0; e < s.tree.elements.size(); ++e) {
    if (!s.tree.elements[e].is_leaf()) continue;
    const ElementLight& l = s.light.elements[e];
    absorbed += s.tree.elements[e].area_m2 *
                double(luminance((Rgb{1, 1, 1} - l.reflectance) * l.irradiance));
    emitted += s.tree.elements[e].area_m2 * double(luminance(l.emission));
  }
  return absorbed / emitted;
}

Result<Iterated> begin_iterating(const scene::Scene& scene, const trace::RayTracer& tracer,
                                 const SolveParams& params, Progress& progress) {
  // Faces, cut where others stand on them, under clusters.
  Iterated out;
  Solution& s = out.solution;
  LUXEL_TRY(s.faces, make_faces(scene, progress));
  s.blockers = make_blockers(s.faces);
  s.tree = make_tree(cut_at_contacts(s.faces, s.blockers));
  s.warnings = overlap_warnings(scene, s.faces, s.blockers);
  // Units and limits for errors.
  s.basis = params.basis;
  s.diagonal_m = scene::world_bounds(scene).diagonal();
  s.unit_area_m2 = area_of(s.tree) / double(std::clamp<size_t>(s.faces.size(), 1, kMostUnits));
  s.min_area_m2 = least_area_of(s, params);
  s.unlinked = unlinked_lights_of(scene);
  double largest_m2 = 0;
  for (const Element& e : s.tree.elements) largest_m2 = std::max(largest_m2, e.area_m2);
  s.light_in_gaps = transport::size_for_covers(scene, tracer, float(std::sqrt(largest_m2))) == 0;
  // Links and light.
  Solving w = solving_of(out, scene, tracer);
  LUXEL_TRY_STATUS(link_first(w, params, progress));
  LUXEL_TRY_STATUS(iterate(s, tracer, params.tolerance, progress));
  return out;
}

Result<bool> iterate_once(Iterated& iterated, const scene::Scene& scene,
                          const trace::RayTracer& tracer, const SolveParams& params,
                          Progress& progress) {
  Solving w = solving_of(iterated, scene, tracer);
  w.s.min_area_m2 = least_area_of(w.s, params);
  const double mean = mean_irradiance(w.s.tree, w.s.light);
  w.s.eps = params.eps ? std::max(*params.eps, kLeastEps * mean) : kUsualEps * mean;
  const RefineParams refining = refine_params(w, params, w.s.eps);
  const size_t leaves = w.s.tree.elements.size();
  LUXEL_TRY_STATUS(light_leaves(w.state, w.x, w.s.unlinked, refining, w.off, progress));
  LUXEL_TRY(const size_t refined, refine(w.state, w.x, refining, progress));
  LUXEL_TRY_STATUS(light_leaves(w.state, w.x, w.s.unlinked, refining, w.off, progress));
  const bool is_settled = refined == 0 && leaves == w.s.tree.elements.size();
  if (!is_settled) ++w.s.iterations;
  LUXEL_TRY_STATUS(iterate(w.s, tracer, params.tolerance, progress));
  return is_settled;
}

Result<Solution> solve(const scene::Scene& scene, const trace::RayTracer& tracer,
                       const SolveParams& params, Progress& progress) {
  LUXEL_TRY(Iterated iterated, begin_iterating(scene, tracer, params, progress));
  Solution& s = iterated.solution;
  for (bool is_settled = false; !is_settled && s.iterations < kMostIterations;) {
    LUXEL_TRY(is_settled, iterate_once(iterated, scene, tracer, params, progress));
  }
  s.all_bounces = params.bounces < 0;
  Solving w = solving_of(iterated, scene, tracer);
  if (!s.all_bounces) count_bounces(w, params.bounces);
  add_warnings(params, s);
  return std::move(s);
}

}  // namespace luxel::hierarchical
