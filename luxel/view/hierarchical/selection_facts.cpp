#include "luxel/view/hierarchical/selection_facts.h"

#include <algorithm>
#include <cmath>

#include "luxel/scene/light_kinds.h"

namespace luxel::view {
namespace {

namespace h = luxel::hierarchical;

/// An edge whose direction leaves a plane by less than this lies in it: corners are floats.
constexpr double kInPlane = 1e-5;

double error_of(const SolutionView& view, uint32_t receiver, const h::Link& link) {
  return double(
      h::error_of(link, receiver, view.solution.exchange(view.tracer), view.solution.light));
}

void add_leaves_below(const h::Tree& tree, uint32_t element, size_t depth, NodeFacts& out) {
  if (tree.elements[element].is_leaf()) {
    ++out.leaves, out.height = std::max(out.height, depth);
    return;
  }
  for (uint32_t c = 0; c < 4; ++c)
    add_leaves_below(tree, tree.elements[element].child + c, depth + 1, out);
}

/// E over the links that end at an element: the mean of what they bring to its corners.
Rgb over_links_of(const h::Solution& s, uint32_t id) {
  const h::Element& e = s.tree.element(id);
  const h::ElementLight& light = s.light.elements[id - s.tree.clusters.size()];
  Rgb sum{};
  for (uint32_t k = 0; k < e.corners; ++k) sum += light.received[k] * (1 / float(e.corners));
  return sum;
}

void add_element(const SolutionView& view, uint32_t id, NodeFacts& out) {
  const h::Solution& s = view.solution;
  const h::Element& e = s.tree.element(id);
  const h::ElementLight& light = s.light.elements[id - s.tree.clusters.size()];
  out.name = name_of_face(view, e.face), out.area_m2 = e.area_m2;
  out.irradiance = light.irradiance, out.radiosity = light.radiosity;
  out.reflectance = light.reflectance, out.over_links = over_links_of(s, id);
  add_leaves_below(s.tree, uint32_t(id - s.tree.clusters.size()), 0, out);
}

void add_cluster(const h::Solution& s, uint32_t id, NodeFacts& out) {
  const h::Cluster& c = s.tree.clusters[id];
  out.is_cluster = true, out.area_m2 = c.area_m2, out.leaves = c.end - c.first;
  for (size_t root = 0; root < s.tree.rank.size(); ++root)
    if (s.tree.rank[root] >= c.first && s.tree.rank[root] < c.end && c.area_m2 > 0)
      out.radiosity +=
          s.light.elements[root].radiosity * float(s.tree.elements[root].area_m2 / c.area_m2);
}

std::string words_for(const SolutionView& view, uint32_t id) {
  const h::Tree& tree = view.solution.tree;
  if (tree.is_cluster(id)) {
    const h::Cluster& c = tree.clusters[id];
    return fmt::format("cluster {} of {} elements", id, c.end - c.first);
  }
  const h::Element& e = tree.element(id);
  return fmt::format("element {} on {}, {:.3g} m2", id - tree.clusters.size(),
                     name_of_face(view, e.face), e.area_m2);
}

/// Distance of an edge from the line through two points [m].
double gap_to(DVec3 from, DVec3 through, const Generator& edge) {
  const DVec3 u = normalize(through - from);
  const auto aside = [&](DVec3 p) { return (p - from) - u * dot(p - from, u); };
  const DVec3 a = aside(edge.from), d = aside(edge.to) - a;
  const double square = dot(d, d);
  const double t = square > 0 ? std::clamp(-dot(a, d) / square, 0.0, 1.0) : 0;
  return length(a + d * t);
}

/// The corner of one polygon and the edge of another in whose plane a line lies best.
struct Wedge {
  DVec3 vertex;
  Generator edge;
  /// True: an edge at the vertex lies in that plane, too.
  bool is_double = false;
};
std::optional<Wedge> wedge_of(const h::Discontinuity& line, h::PolygonView vertices,
                              h::PolygonView edges) {
  std::optional<Wedge> out;
  double least = INFINITY;
  const DVec3 middle = (line.a + line.b) * 0.5;
  for (size_t i = 0; i < vertices.size(); ++i)
    for (size_t k = 0; k < edges.size(); ++k) {
      const Generator edge{edges[k], edges[(k + 1) % edges.size()]};
      double gap = 0;
      for (const DVec3& p : {line.a, middle, line.b})
        gap = std::max(gap, gap_to(p, vertices[i], edge));
      if (gap >= least) continue;
      least = gap, out = Wedge{vertices[i], edge};
      const DVec3 normal = normalize(cross(edge.from - vertices[i], edge.to - vertices[i]));
      for (const size_t j : {i + 1, i + vertices.size() - 1}) {
        const DVec3 along = normalize(vertices[j % vertices.size()] - vertices[i]);
        if (length(along) > 0 && std::abs(dot(along, normal)) < kInPlane) out->is_double = true;
      }
    }
  return out;
}

void find_generators(const SolutionView& view, h::PolygonView source, DiscontinuityFacts& out) {
  const h::Polygon& blocker = view.solution.faces.faces[out.line.blocker].corners;
  const bool is_ve = out.line.kind == h::DiscontinuityKind::ve;
  const auto wedge =
      is_ve ? wedge_of(out.line, source, blocker) : wedge_of(out.line, blocker, source);
  if (!wedge) return;
  const Generator vertex{wedge->vertex, wedge->vertex};
  out.at_source = is_ve ? vertex : wedge->edge, out.at_blocker = is_ve ? wedge->edge : vertex;
  out.degree = wedge->is_double ? 1 : 2;
}

void add_punctual(const SolutionView& view, DiscontinuityFacts& out) {
  const scene::PunctualLight& light = view.scene.lights[out.line.source - h::kPunctualSource];
  out.degree = 0;
  out.source = light.name.empty() ? std::string(scene::name_of(light.kind)) : light.name;
  if (!scene::has_position(light.kind)) return;
  const std::array<DVec3, 1> place{to_double(light.position)};
  find_generators(view, place, out);
  out.degree = 0;
}

}  // namespace

std::string name_of_face(const SolutionView& view, uint32_t face) {
  const h::Face& f = view.solution.faces.faces[face];
  const std::string& name = view.scene.instances[f.instance].name;
  const std::string& material = view.scene.materials[f.material].name;
  return (name.empty() ? fmt::format("instance {}", f.instance) : name) +
         (material.empty() ? "" : ", " + material);
}

NodeFacts facts_of(const SolutionView& view, std::span<const uint32_t> path, size_t level) {
  const h::Solution& s = view.solution;
  NodeFacts out;
  out.id = path[level], out.eps = s.eps;
  if (s.tree.is_cluster(out.id))
    add_cluster(s, out.id, out);
  else
    add_element(view, out.id, out);
  for (size_t k = 0; k < level; ++k) {
    out.depth += s.tree.is_cluster(path[k]) == out.is_cluster;
    out.links_above += s.links.of[path[k]].size();
  }
  out.links = s.links.of[out.id].size();
  for (const h::Link& link : s.links.of[out.id]) {
    const double error = error_of(view, out.id, link);
    out.most_error = std::max(out.most_error, error), out.sum_of_errors += error;
    out.over_eps += error > s.eps;
  }
  return out;
}

LinkFacts facts_of(const SolutionView& view, const LinkNumber& number) {
  const h::Solution& s = view.solution;
  const h::Link& link = s.links.of[number.receiver][number.number];
  LinkFacts out;
  out.receiver = words_for(view, number.receiver), out.source = words_for(view, link.source);
  out.is_far = s.tree.is_cluster(number.receiver) || s.tree.is_cluster(link.source);
  out.distance_m = length(middle_of(s.tree, number.receiver) - middle_of(s.tree, link.source));
  out.form_factor = double(link.factor), out.visible = double(link.visible);
  out.irradiance = h::irradiance_of(link, s.exchange(view.tracer), s.light);
  out.error = error_of(view, number.receiver, link), out.eps = s.eps;
  out.blockers = link.blockers, out.is_crowded = link.crowded;
  if (out.is_crowded)
    h::find_between(s.blockers, s.tree.element(number.receiver).polygon(),
                    s.tree.element(link.source).polygon(), out.blockers);
  return out;
}

TriangleFacts triangle_facts(const SolutionView& view, uint32_t triangle) {
  const h::LightTriangle& t = view.mesh->triangles[triangle];
  const h::Interpolant& r = view.mesh->interpolant[triangle];
  TriangleFacts out;
  for (size_t k = 0; k < 3; ++k) {
    out.corner[k] = view.mesh->vertices[t.vertex[k]];
    out.line_edges += t.edge_is_line[k];
  }
  constexpr std::array<std::array<float, 2>, 6> kPlaces{
      {{0, 0}, {0.5f, 0}, {1, 0}, {0.5f, 0.5f}, {0, 1}, {0, 0.5f}}};
  for (size_t k = 0; k < 6; ++k) out.value[k] = h::value_of(r, kPlaces[k][0], kPlaces[k][1]);
  for (size_t k = 0; k < 6; k += 2) {
    const Rgb off = out.value[k + 1] - (out.value[k] + out.value[(k + 2) % 6]) * 0.5f;
    out.bend = std::max({out.bend, max_component(off), max_component(-off)});
  }
  out.area_m2 = viewfactor::area_m2(out.corner), out.leaf = t.leaf;
  return out;
}

DiscontinuityFacts facts_of(const SolutionView& view, uint32_t receiver,
                            const h::Discontinuity& line) {
  const h::Solution& s = view.solution;
  DiscontinuityFacts out;
  out.line = line, out.receiver = receiver;
  out.weight = h::weight_of(line, s, view.scene), out.ranking = view.discontinuity.ranking;
  if (line.blocker != h::kNone) out.blocker = name_of_face(view, line.blocker);
  if (line.kind == h::DiscontinuityKind::contact) {
    out.degree = 0;
  } else if (line.source >= h::kPunctualSource) {
    add_punctual(view, out);
  } else {
    out.source = name_of_face(view, line.source);
    const h::Polygon above = viewfactor::clip_above(
        s.faces.faces[line.source].corners, s.faces.faces[receiver].plane, s.blockers.slack_m);
    out.degree = 1;
    if (line.kind != h::DiscontinuityKind::horizon) find_generators(view, above, out);
  }
  return out;
}

}  // namespace luxel::view
