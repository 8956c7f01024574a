#include "luxel/view/hierarchical/selection_shapes.h"

#include <algorithm>

#include "luxel/pipeline/render/overlays.h"
#include "luxel/viewfactor/shaft.h"

namespace luxel::view {
namespace {

namespace h = luxel::hierarchical;

constexpr Rgb kPickedYellow{1, 0.85f, 0.1f}, kPickedBlue{0.3f, 0.55f, 1},
    kPickedRed{1, 0.2f, 0.15f}, kPickedGrey{0.45f, 0.45f, 0.45f}, kPickedWhite{1, 1, 1},
    kPickedGreen{0.1f, 0.8f, 0.2f}, kPickedViolet{0.65f, 0.25f, 0.95f};
/// Links of one element that are drawn: the strongest.
constexpr size_t kMostShownLinks = 300;

void add_stroke(DVec3 from, DVec3 to, Rgb color, SelectionShapes& out) {
  out.lines.push_back({to_float(from), to_float(to), color});
}

void add_outline(h::PolygonView polygon, Rgb color, SelectionShapes& out) {
  for (size_t k = 0; k < polygon.size(); ++k)
    add_stroke(polygon[k], polygon[(k + 1) % polygon.size()], color, out);
}

void add_area(h::PolygonView polygon, Rgb color, float opacity, SelectionShapes& out) {
  for (size_t k = 1; k + 1 < polygon.size(); ++k)
    out.areas.push_back(
        {{to_float(polygon[0]), to_float(polygon[k]), to_float(polygon[k + 1])}, color, opacity});
}

void add_box(DVec3 lower, DVec3 upper, Rgb color, SelectionShapes& out) {
  const auto corner = [&](int k) {
    return DVec3{k & 1 ? upper.x : lower.x, k & 2 ? upper.y : lower.y, k & 4 ? upper.z : lower.z};
  };
  for (int k = 0; k < 8; ++k)
    for (const int axis : {1, 2, 4})
      if (!(k & axis)) add_stroke(corner(k), corner(k | axis), color, out);
}

/// The outline of an element, the box of a cluster.
void add_body(const h::Tree& tree, uint32_t id, Rgb color, SelectionShapes& out) {
  if (tree.is_cluster(id))
    add_box(tree.clusters[id].lower, tree.clusters[id].upper, color, out);
  else
    add_outline(tree.element(id).polygon(), color, out);
}

Rgb color_of_link(const h::Link& link) { return link.visible < 1 ? kPickedGreen : kPickedWhite; }

void add_links_of(const SolutionView& view, uint32_t id, SelectionShapes& out) {
  const h::Solution& s = view.solution;
  const h::Exchange x = s.exchange(view.tracer);
  std::vector<std::pair<float, const h::Link*>> strong;
  for (const h::Link& link : s.links.of[id])
    strong.push_back({luminance(h::irradiance_of(link, x, s.light)), &link});
  std::stable_sort(strong.begin(), strong.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  for (size_t k = 0; k < std::min(kMostShownLinks, strong.size()); ++k)
    pipeline::add_arrow(middle_of(s.tree, strong[k].second->source), middle_of(s.tree, id),
                        pipeline::kArrowHead * double(s.diagonal_m),
                        color_of_link(*strong[k].second), out.lines);
}

/// A corner or an edge that makes a discontinuity, and the rays past it to the line's ends.
void add_rays(const Generator& source, const h::Discontinuity& line, SelectionShapes& out) {
  add_stroke(source.from, line.a, kPickedGrey, out);
  add_stroke(source.to, line.b, kPickedGrey, out);
}

/// Edges that meet the line in the order of its ends.
Generator along(const Generator& part, const h::Discontinuity& line) {
  const bool turns = dot(part.to - part.from, line.b - line.a) < 0;
  return turns ? Generator{part.to, part.from} : part;
}

}  // namespace

void add_node(const SolutionView& view, uint32_t id, bool has_links, SelectionShapes& out) {
  const h::Tree& tree = view.solution.tree;
  if (has_links) add_links_of(view, id, out);
  if (!tree.is_cluster(id) && !tree.element(id).is_leaf())
    for (uint32_t c = 0; c < 4; ++c)
      add_outline(tree.elements[tree.element(id).child + c].polygon(), kPickedGrey, out);
  if (!tree.is_cluster(id)) add_area(tree.element(id).polygon(), kPickedYellow, 0.15f, out);
  add_body(tree, id, kPickedYellow, out);
}

void add_link(const SolutionView& view, const LinkNumber& number, SelectionShapes& out) {
  const h::Solution& s = view.solution;
  const h::Link& link = s.links.of[number.receiver][number.number];
  if (!s.tree.is_cluster(number.receiver) && !s.tree.is_cluster(link.source)) {
    const h::PolygonView a = s.tree.element(number.receiver).polygon();
    const h::PolygonView b = s.tree.element(link.source).polygon();
    for (const auto& edge : shaft_edges(a, b, s.blockers.slack_m))
      add_stroke(edge[0], edge[1], kPickedGrey, out);
    for (const uint32_t face : facts_of(view, number).blockers) {
      add_area(s.faces.faces[face].corners, kPickedRed, 0.15f, out);
      add_outline(s.faces.faces[face].corners, kPickedRed, out);
    }
  }
  add_body(s.tree, number.receiver, kPickedBlue, out);
  add_body(s.tree, link.source, kPickedYellow, out);
  pipeline::add_arrow(middle_of(s.tree, link.source), middle_of(s.tree, number.receiver),
                      pipeline::kArrowHead * double(s.diagonal_m), color_of_link(link), out.lines);
}

void add_triangle(const SolutionView& view, uint32_t triangle, SelectionShapes& out) {
  const std::array<DVec3, 3> corner = triangle_facts(view, triangle).corner;
  add_area(corner, kPickedYellow, 0.25f, out);
  add_outline(corner, kPickedYellow, out);
}

void add_discontinuity(const SolutionView& view, const DiscontinuityFacts& facts,
                       SelectionShapes& out) {
  const std::vector<h::Face>& faces = view.solution.faces.faces;
  const h::Discontinuity& line = facts.line;
  add_outline(faces[facts.receiver].corners, kPickedBlue, out);
  if (line.blocker != h::kNone) add_outline(faces[line.blocker].corners, kPickedRed, out);
  if (line.source < faces.size()) add_outline(faces[line.source].corners, kPickedYellow, out);
  if (facts.at_source) {
    const Generator part = along(*facts.at_source, line);
    add_rays(part, line, out);
    add_stroke(part.from, part.to, kPickedYellow, out);
  }
  if (facts.at_blocker) {
    const Generator part = along(*facts.at_blocker, line);
    add_stroke(part.from, part.to, kPickedRed, out);
  }
  add_stroke(line.a, line.b, kPickedViolet, out);
}

void add_backprojection(const BackprojectionProbe& probe, SelectionShapes& out) {
  for (const SeenSource& source : probe.sources) {
    for (const DVec3& corner : source.above)
      add_stroke(probe.at.position, corner, kPickedGrey, out);
    for (const h::Polygon& part : source.visible) {
      add_area(part, kPickedWhite, 0.4f, out);
      add_outline(part, kPickedGreen, out);
    }
    add_outline(source.outline, kPickedViolet, out);
  }
}

std::vector<std::array<DVec3, 2>> shaft_edges(h::PolygonView a, h::PolygonView b, double slack_m) {
  const viewfactor::Shaft shaft = viewfactor::shaft_between(a, b, slack_m);
  std::vector<std::array<DVec3, 2>> out;
  for (const DVec3& p : a)
    for (const DVec3& q : b) {
      // An edge of the hull lies in two of its sides; planes that are found twice count once.
      std::vector<DVec3> sides;
      for (size_t k = 2; k < shaft.planes.size(); ++k) {  // after the planes of a and b
        const Plane& side = shaft.planes[k];
        const bool is_known = std::any_of(sides.begin(), sides.end(), [&](const DVec3& n) {
          return dot(n, side.normal) > 1 - 1e-9;
        });
        if (!is_known && std::abs(side.height(p)) <= 2 * slack_m &&
            std::abs(side.height(q)) <= 2 * slack_m)
          sides.push_back(side.normal);
      }
      if (sides.size() >= 2) out.push_back({p, q});
    }
  return out;
}

}  // namespace luxel::view
