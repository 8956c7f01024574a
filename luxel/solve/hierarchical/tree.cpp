#include "luxel/solve/hierarchical/tree.h"

#include <algorithm>
#include <numeric>

#include "luxel/base/check.h"

namespace luxel::hierarchical {
namespace {

/// A quadrilateral longer than this many times its width is divided across: quarters are as long.
constexpr double kLong = 3;

Parts parts_of(PolygonView p) {
  if (p.size() == 3) return Parts::quarters;
  const double first = length(p[1] - p[0]) + length(p[2] - p[3]),
               last = length(p[2] - p[1]) + length(p[3] - p[0]);
  return first > kLong * last   ? Parts::along_first
         : last > kLong * first ? Parts::along_last
                                : Parts::quarters;
}

Element make_element(PolygonView corners, uint32_t face, uint32_t parent) {
  LUXEL_CHECK(corners.size() == 3 || corners.size() == 4);
  Element e;
  std::copy(corners.begin(), corners.end(), e.corner.begin());
  e.corners = uint32_t(corners.size());
  e.parts = parts_of(corners);
  e.face = face, e.parent = parent;
  e.area_m2 = viewfactor::area_m2(corners);
  e.centre = viewfactor::mean_corner(corners);
  e.radius_m = viewfactor::radius_about(e.centre, corners);
  return e;
}

/// A convex polygon as quadrilaterals and at most one triangle, all with its first corner.
void add_roots(PolygonView p, uint32_t face, std::vector<Element>& out) {
  for (size_t k = 1; k + 1 < p.size(); k += 2) {
    std::vector<DVec3> piece{p[0], p[k], p[k + 1]};
    if (k + 2 < p.size()) piece.push_back(p[k + 2]);
    out.push_back(make_element(piece, face, kNone));
  }
}

struct Bounds {
  DVec3 lower{INFINITY, INFINITY, INFINITY}, upper{-INFINITY, -INFINITY, -INFINITY};
  void add(DVec3 p) {
    lower = {std::min(lower.x, p.x), std::min(lower.y, p.y), std::min(lower.z, p.z)};
    upper = {std::max(upper.x, p.x), std::max(upper.y, p.y), std::max(upper.z, p.z)};
  }
};

double along(DVec3 p, int axis) { return axis == 0 ? p.x : axis == 1 ? p.y : p.z; }

/// Clusters over `roots`, depth first; returns the id of the one over all. Halves have as many
/// roots each, so depths differ by one at most.
uint32_t add_clusters(Tree& tree, std::span<uint32_t> roots, uint32_t first, size_t cluster_count) {
  if (roots.size() == 1) {
    tree.rank[roots[0]] = first;
    return uint32_t(cluster_count + roots[0]);
  }
  Bounds bounds, centres;
  double area = 0;
  for (const uint32_t r : roots) {
    for (const DVec3& p : tree.elements[r].polygon()) bounds.add(p);
    centres.add(tree.elements[r].centre);
    area += tree.elements[r].area_m2;
  }
  // Halves along the longest side of the centres' box.
  const DVec3 size = centres.upper - centres.lower;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const auto key = [&](uint32_t r) { return std::pair(along(tree.elements[r].centre, axis), r); };
  const size_t half = roots.size() / 2;
  std::nth_element(roots.begin(), roots.begin() + std::ptrdiff_t(half), roots.end(),
                   [&](uint32_t a, uint32_t b) { return key(a) < key(b); });
  // The cluster comes before those below it.
  const auto id = uint32_t(tree.clusters.size());
  Cluster cluster;
  cluster.lower = bounds.lower, cluster.upper = bounds.upper;
  cluster.centre = (bounds.lower + bounds.upper) * 0.5;
  cluster.radius_m = 0.5 * length(bounds.upper - bounds.lower);
  cluster.area_m2 = area;
  cluster.first = first, cluster.end = first + uint32_t(roots.size());
  tree.clusters.push_back(cluster);
  const uint32_t low = add_clusters(tree, roots.first(half), first, cluster_count);
  const uint32_t high =
      add_clusters(tree, roots.subspan(half), first + uint32_t(half), cluster_count);
  tree.clusters[id].child = {low, high};
  return id;
}

}  // namespace

Tree make_tree(std::span<const std::vector<Polygon>> pieces) {
  Tree tree;
  for (uint32_t f = 0; f < pieces.size(); ++f) {
    tree.first_root.push_back(uint32_t(tree.elements.size()));
    for (const Polygon& piece : pieces[f]) add_roots(piece, f, tree.elements);
  }
  tree.first_root.push_back(uint32_t(tree.elements.size()));
  std::vector<uint32_t> roots(tree.elements.size());
  std::iota(roots.begin(), roots.end(), 0u);
  if (!roots.empty()) {
    tree.clusters.reserve(roots.size() - 1);
    tree.rank.resize(roots.size());
    add_clusters(tree, roots, 0, roots.size() - 1);
  }
  return tree;
}

void divide(Tree& tree, size_t index) {
  LUXEL_CHECK(tree.elements[index].is_leaf());
  const Element e = tree.elements[index];
  tree.elements[index].child = uint32_t(tree.elements.size());
  for (uint32_t part = 0; part < 4; ++part) {
    const std::array<DVec3, 4> corner = part_of(e.corner, e.corners, part, e.parts);
    tree.elements.push_back(make_element({corner.data(), e.corners}, e.face, uint32_t(index)));
  }
}

DVec3 point_in(const Element& e, Vec2 u) {
  const auto& c = e.corner;
  if (e.corners == 3) {
    const double root = std::sqrt(double(u.x)), v = double(u.y);
    return c[0] * (1 - root) + (c[1] * (1 - v) + c[2] * v) * root;
  }
  return linear_at(c, 4, u.x, u.y);
}

std::array<double, 2> place_in(const Element& e, DVec3 place) {
  const auto& c = e.corner;
  std::array<double, 2> at{1 / 3.0, 1 / 3.0};
  // Newton's method: at once on triangles and parallelograms, after some steps on what they are cut
  // into where others stand on them.
  for (int step = 0; step < 8; ++step) {
    const auto [s, t] = at;
    const DVec3 u = e.corners == 3 ? c[1] - c[0] : (c[1] - c[0]) * (1 - t) + (c[2] - c[3]) * t;
    const DVec3 v = e.corners == 3 ? c[2] - c[0] : (c[3] - c[0]) * (1 - s) + (c[2] - c[1]) * s;
    const DVec3 d = place - linear_at(c, e.corners, s, t);
    const double uu = dot(u, u), uv = dot(u, v), vv = dot(v, v), det = uu * vv - uv * uv;
    if (!(det > 0)) break;
    at[0] = std::clamp(s + (vv * dot(d, u) - uv * dot(d, v)) / det, 0.0, 1.0);
    at[1] = std::clamp(t + (uu * dot(d, v) - uv * dot(d, u)) / det, 0.0, 1.0);
  }
  return at;
}

double depth_inside(PolygonView polygon, DVec3 normal, DVec3 point) {
  double depth = INFINITY;
  for (size_t k = 0; k < polygon.size(); ++k) {
    const DVec3 edge = polygon[(k + 1) % polygon.size()] - polygon[k];
    const double size = length(edge);
    if (size > 0) depth = std::min(depth, dot(cross(normal, edge), point - polygon[k]) / size);
  }
  return depth;
}

size_t leaf_at(const Tree& tree, const Faces& faces, uint32_t face, DVec3 point) {
  const DVec3 normal = faces.faces[face].plane.normal;
  const auto deepest = [&](size_t first, size_t count) {
    size_t best = first;
    double depth = -INFINITY;
    for (size_t e = first; e < first + count; ++e)
      if (const double d = depth_inside(tree.elements[e].polygon(), normal, point); d > depth)
        depth = d, best = e;
    return best;
  };
  size_t at = deepest(tree.first_root[face], tree.first_root[face + 1] - tree.first_root[face]);
  while (!tree.elements[at].is_leaf()) at = deepest(tree.elements[at].child, 4);
  return at;
}

}  // namespace luxel::hierarchical
