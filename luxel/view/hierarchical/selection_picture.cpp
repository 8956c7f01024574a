// Lines and areas that show the selection and the results of the probes over the scene.
#include <algorithm>

#include "luxel/view/hierarchical/selection.h"

namespace luxel::view {
namespace {

namespace h = luxel::hierarchical;

// As the thesis has them: exact light, what interpolation makes of it, and the difference.
constexpr Rgb kExactColor{1, 1, 1}, kShownColor{0.3f, 0.5f, 1}, kErrorColor{1, 0.2f, 0.15f};

float most_of_graph(std::span<const Rgb> a, std::span<const Rgb> b) {
  float out = 0;
  for (const auto& values : {a, b})
    for (const Rgb& e : values) out = std::max(out, luminance(e));
  return out;
}

/// Heights over a surface, in metres, and the curves that are drawn, as kGraphCurves has them.
struct GraphScale {
  DVec3 normal;
  double m_per_unit = 0;
  std::array<bool, kGraphCurves.size()> shows{true, true, true};

  Vec3 at(DVec3 place, float value) const {
    return to_float(place + normal * (m_per_unit * double(value)));
  }
};

/// The largest value is so high.
GraphScale scale_of_graph(const Examined& examined, uint32_t face, double height_m, float most) {
  GraphScale out;
  out.normal = examined.view.solution.faces.faces[face].plane.normal;
  out.m_per_unit = most > 0 ? height_m / double(most) : 0;
  return out;
}

/// Two values, and by how much they differ.
void add_graph_edge(const GraphScale& scale, DVec3 p, DVec3 q, const std::array<Rgb, 2>& exact,
                    const std::array<Rgb, 2>& shown, SelectionShapes& out) {
  const std::array<float, 2> e{luminance(exact[0]), luminance(exact[1])};
  const std::array<float, 2> s{luminance(shown[0]), luminance(shown[1])};
  const auto add = [&](size_t curve, float from, float to, Rgb color) {
    if (scale.shows[curve]) out.lines.push_back({scale.at(p, from), scale.at(q, to), color});
  };
  add(1, s[0], s[1], kShownColor), add(0, e[0], e[1], kExactColor);
  add(2, std::abs(s[0] - e[0]), std::abs(s[1] - e[1]), kErrorColor);
}

void add_graph(const Examined& examined, const SelectionDesk& desk, SelectionShapes& out) {
  const Curve& curve = desk.probed.graph->curve;
  const DVec3 from = curve.line.from, to = curve.line.to;
  out.lines.push_back({to_float(from), to_float(to), {1, 0.85f, 0.1f}});
  const double height_m = double(desk.graph_height) * length(to - from);
  if (const auto& grid = desk.probed.graph->surface) {
    GraphScale scale =
        scale_of_graph(examined, grid->face, height_m, most_of_graph(grid->exact, grid->shown));
    scale.shows = desk.graph_shows;
    for (const auto& [a, b] : grid->edges)
      add_graph_edge(scale, grid->places[a], grid->places[b], {grid->exact[a], grid->exact[b]},
                     {grid->shown[a], grid->shown[b]}, out);
    return;
  }
  GraphScale scale =
      scale_of_graph(examined, curve.line.face, height_m, most_of_graph(curve.exact, curve.shown));
  scale.shows = desk.graph_shows;
  const DVec3 along = normalize(to - from);
  for (size_t k = 1; k < curve.exact.size(); ++k)
    add_graph_edge(scale, from + along * double(curve.at_m[k - 1]),
                   from + along * double(curve.at_m[k]), {curve.exact[k - 1], curve.exact[k]},
                   {curve.shown[k - 1], curve.shown[k]}, out);
}

/// Sticks on the surface: exact light is as high as any, shown light what that makes it.
void add_light_probe(const Examined& examined, const LightProbe& probe, SelectionShapes& out) {
  constexpr double kStickHeight = 0.1;  // over the scene's diagonal
  const float exact = luminance(probe.exact), shown = luminance(probe.interpolated);
  const GraphScale scale = scale_of_graph(
      examined, probe.at.face, kStickHeight * double(examined.view.solution.diagonal_m), exact);
  const DVec3 aside = h::plane_coordinates(examined.view.solution.faces.faces[probe.at.face]).u *
                      (0.004 * double(examined.view.solution.diagonal_m));
  const DVec3 p = probe.at.position, q = p + aside;
  out.lines.push_back({to_float(p), scale.at(p, exact), kExactColor});
  out.lines.push_back({to_float(q), scale.at(q, shown), kShownColor});
}

void extend_over(const h::Tree& tree, uint32_t id, Box3& box) {
  if (tree.is_cluster(id))
    box.extend(to_float(tree.clusters[id].lower)), box.extend(to_float(tree.clusters[id].upper));
  else
    for (const DVec3& corner : tree.element(id).polygon()) box.extend(to_float(corner));
}

}  // namespace

Box3 selected_box(const Examined& examined, const SelectionDesk& desk) {
  const Selection& selected = desk.selected;
  const h::Tree& tree = examined.view.solution.tree;
  Box3 out;
  if (selected.link)
    extend_over(tree, selected.link->receiver, out), extend_over(tree, selected.link_source, out);
  else if (selected.has_element())
    extend_over(tree, selected.path[selected.level], out);
  if (selected.triangle)
    for (const DVec3& corner : triangle_facts(examined.view, *selected.triangle).corner)
      out.extend(to_float(corner));
  if (const auto& edge = selected.discontinuity)
    out.extend(to_float(edge->line.a)), out.extend(to_float(edge->line.b));
  return out;
}

SelectionShapes shapes_of(const Examined& examined, const SelectionDesk& desk) {
  SelectionShapes out;
  const Selection& selected = desk.selected;
  if (selected.link)
    add_link(examined.view, *selected.link, out);
  else if (selected.has_element())
    add_node(examined.view, selected.path[selected.level], !desk.probed.graph, out);
  if (selected.triangle) add_triangle(examined.view, *selected.triangle, out);
  if (selected.discontinuity) add_discontinuity(examined.view, *selected.discontinuity, out);
  if (desk.probed.sources) add_backprojection(*desk.probed.sources, out);
  if (desk.probed.light) add_light_probe(examined, *desk.probed.light, out);
  if (desk.probed.graph) add_graph(examined, desk, out);
  return out;
}

}  // namespace luxel::view
