#include "luxel/solve/hemicube/bisect.h"

#include "luxel/base/check.h"
#include "luxel/base/vec_double.h"

namespace luxel::hemicube {
namespace {

uint64_t key(uint32_t a, uint32_t b) { return (uint64_t(std::min(a, b)) << 32) | std::max(a, b); }

Barycentric middle(Barycentric a, Barycentric b) {
  return {0.5f * (a.u + b.u), 0.5f * (a.v + b.v)};
}

}  // namespace

Bisector::Bisector(Mesh& mesh) : mesh_(mesh) {
  for (uint32_t i = 0; i < mesh.nodes.size(); ++i)
    if (mesh.nodes[i].child == 0 && !is_flat(mesh, mesh.nodes[i]))
      for (uint8_t k = 0; k < 3; ++k) link(i, k);
}

void Bisector::link(uint32_t node, uint8_t k) {
  const Node& n = mesh_.nodes[node];
  triangles_at_[key(n.point[k], n.point[(k + 1) % 3])].push_back(node);
}

void Bisector::replace(Edge edge, uint32_t node, uint32_t by) {
  std::vector<uint32_t>& at = triangles_at_[edge];
  *std::find(at.begin(), at.end(), node) = by;
}

/// Lengths that are equal are told apart by the edges' numbers, so that all triangles at an edge
/// agree which of two edges is the longer one.
Bisector::Longest Bisector::longest(uint32_t node) const {
  const Node& n = mesh_.nodes[node];
  Longest best;
  for (uint8_t k = 0; k < 3; ++k) {
    const uint32_t a = n.point[k], b = n.point[(k + 1) % 3];
    // From the lower number to the higher: the same rounding for all triangles at the edge.
    const DVec3 d =
        to_double(mesh_.points[std::max(a, b)]) - to_double(mesh_.points[std::min(a, b)]);
    const double length2 = dot(d, d);
    const Edge edge = key(a, b);
    if (k == 0 || length2 > best.length2 || (length2 == best.length2 && edge > best.edge))
      best = {length2, edge, k};
  }
  return best;
}

double Bisector::longest_edge2(uint32_t node) const { return longest(node).length2; }

void Bisector::cut(uint32_t node, size_t most) {
  // Each step goes to a triangle whose longest edge is longer than the one before: it ends.
  std::vector<uint32_t> path{node};
  while (!path.empty()) {
    const uint32_t t = path.back();
    if (mesh_.nodes[t].child != 0) {
      path.pop_back();
      continue;
    }
    const Edge edge = longest(t).edge;
    uint32_t first = kNone;
    for (const uint32_t other : triangles_at_.at(edge))
      if (first == kNone && longest(other).edge != edge) first = other;
    if (first != kNone) {
      path.push_back(first);
      continue;
    }
    const size_t count = triangles_at_.at(edge).size();
    if (count > most) return;
    most -= count;
    cut_all_at(edge);
  }
}

void Bisector::cut_all_at(Edge edge) {
  const std::vector<uint32_t> at = std::move(triangles_at_.at(edge));
  triangles_at_.erase(edge);
  const uint32_t a = uint32_t(edge >> 32), b = uint32_t(edge);
  const uint32_t point = uint32_t(mesh_.points.size());
  mesh_.points.push_back(0.5f * (mesh_.points[a] + mesh_.points[b]));
  for (const uint32_t node : at) halve(node, longest(node).k, point);
}

uint32_t Bisector::middle_vertex(const Node& node, uint8_t k, uint32_t point) {
  const uint8_t next = uint8_t((k + 1) % 3);
  const auto [entry, is_new] = middle_vertex_.try_emplace(key(node.vertex[k], node.vertex[next]),
                                                          uint32_t(mesh_.vertices.size()));
  // Vertices of two creases may bound the same edge on different surfaces: the middle must be ours.
  if (!is_new && mesh_.point_of[entry->second] == point) return entry->second;
  entry->second = uint32_t(mesh_.vertices.size());
  mesh_.vertices.push_back({node.instance, node.triangle, middle(node.at[k], node.at[next])});
  mesh_.point_of.push_back(point);
  return entry->second;
}

void Bisector::halve(uint32_t index, uint8_t k, uint32_t point) {
  const Node n = mesh_.nodes[index];
  const uint8_t next = uint8_t((k + 1) % 3), top = uint8_t((k + 2) % 3);
  const uint32_t vertex = middle_vertex(n, k, point);
  const Barycentric at = middle(n.at[k], n.at[next]);
  const uint32_t child = uint32_t(mesh_.nodes.size());
  Node first = n, second = n;
  first.vertex = {n.vertex[k], vertex, n.vertex[top]};
  first.point = {n.point[k], point, n.point[top]};
  first.at = {n.at[k], at, n.at[top]};
  second.vertex = {vertex, n.vertex[next], n.vertex[top]};
  second.point = {point, n.point[next], n.point[top]};
  second.at = {at, n.at[next], n.at[top]};
  mesh_.nodes.push_back(first), mesh_.nodes.push_back(second);
  mesh_.nodes[index].child = child, mesh_.nodes[index].cut_edge = k;
  ++mesh_.triangle_count;
  replace(key(n.point[top], n.point[k]), index, child);
  replace(key(n.point[next], n.point[top]), index, child + 1);
  link(child, 0);
  link(child + 1, 0);
  triangles_at_[key(point, n.point[top])].push_back(child);
  triangles_at_[key(point, n.point[top])].push_back(child + 1);
}

}  // namespace luxel::hemicube
