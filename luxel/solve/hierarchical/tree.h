// Elements: faces and the parts that they are divided into, four by four, under clusters of faces.
#pragma once

#include <array>
#include <span>

#include "luxel/solve/hierarchical/faces.h"

namespace luxel::hierarchical {

/// Ways to divide an element into four: by the middles of its edges; or, a long quadrilateral,
/// across, into a row along its first edge or its last one.
enum class Parts : uint8_t { quarters, along_first, along_last };

/// A quadrilateral or a triangle of a face: the whole of it, one of the pieces of a face with more
/// corners, or one of the four parts of another element.
struct Element {
  std::array<DVec3, 4> corner;
  uint32_t corners = 4;  ///< 3 or 4
  Parts parts = Parts::quarters;
  uint32_t face = 0;
  uint32_t parent = kNone;
  uint32_t child = kNone;  ///< the first of four in a row; kNone: a leaf
  double area_m2 = 0;
  DVec3 centre;
  double radius_m = 0;

  PolygonView polygon() const { return {corner.data(), corners}; }
  bool is_leaf() const { return child == kNone; }
};

/// Two clusters or elements, by their ids, and what they fill.
struct Cluster {
  std::array<uint32_t, 2> child{};
  DVec3 lower, upper;
  DVec3 centre;
  double radius_m = 0;
  double area_m2 = 0;           ///< of all surfaces below
  uint32_t first = 0, end = 0;  ///< the ranks of the roots below
};

/// Clusters and elements have ids in common: clusters first, whose number is settled, then elements
/// as they come. Id 0 is the root: a cluster, or the only element.
struct Tree {
  std::vector<Cluster> clusters;
  std::vector<Element> elements;
  std::vector<uint32_t> rank;  ///< per root its place in the order in which clusters hold them
  std::vector<uint32_t> first_root;  ///< per face its elements that nothing divides; one extra
                                     ///< entry. Roots come first of all elements.

  size_t size() const { return clusters.size() + elements.size(); }
  bool is_cluster(uint32_t id) const { return id < clusters.size(); }
  const Element& element(uint32_t id) const { return elements[id - clusters.size()]; }
  uint32_t id_of(size_t element) const { return uint32_t(clusters.size() + element); }
};

/// From the convex pieces of each face: see contacts.h.
Tree make_tree(std::span<const std::vector<Polygon>> pieces);

/// Divides a leaf as its `parts` say: by the middles of its edges a quadrilateral into four that
/// meet in its centre, a triangle into three at its corners and one between. The parts are convex
/// and fill it.
void divide(Tree& tree, size_t element);

/// Corner values of a part that divide() makes, for a quantity that is linear over the whole:
/// places, or light.
template <class T>
std::array<T, 4> part_of(const std::array<T, 4>& v, uint32_t n, uint32_t part,
                         Parts parts = Parts::quarters) {
  if (parts != Parts::quarters) {
    const bool first = parts == Parts::along_first;
    const auto between = [&](const T& a, const T& b, uint32_t k) {
      return a * (1 - 0.25f * float(k)) + b * (0.25f * float(k));
    };
    const auto near = [&](uint32_t k) { return between(v[0], first ? v[1] : v[3], k); };
    const auto far = [&](uint32_t k) { return between(first ? v[3] : v[1], v[2], k); };
    if (first) return {near(part), near(part + 1), far(part + 1), far(part)};
    return {near(part), far(part), far(part + 1), near(part + 1)};
  }
  const auto middle = [&](uint32_t k) { return (v[k % n] + v[(k + 1) % n]) * 0.5f; };
  if (n == 4) return {v[part], middle(part), (v[0] + v[1] + v[2] + v[3]) * 0.25f, middle(part + 3)};
  if (part == 3) return {middle(0), middle(1), middle(2)};
  return {v[part], middle(part), middle(part + 2)};
}

/// A function from its values at the corners: bilinear over a quadrilateral, s and t along its
/// first and last edge, or linear over a triangle, s and t the weights of its second and third
/// corner.
template <class T, class Number>
T linear_at(const std::array<T, 4>& v, uint32_t n, Number s, Number t) {
  if (n == 3) return v[0] * (1 - s - t) + v[1] * s + v[2] * t;
  return (v[0] * (1 - s) + v[1] * s) * (1 - t) + (v[3] * (1 - s) + v[2] * s) * t;
}

/// A point of an element for two numbers in [0, 1).
DVec3 point_in(const Element& e, Vec2 u);

/// s and t at which linear_at gives a place of an element's plane, or the nearest ones inside.
std::array<double, 2> place_in(const Element& e, DVec3 place);

/// The leaf of a face in which a point of its plane lies, or lies next to.
size_t leaf_at(const Tree& tree, const Faces& faces, uint32_t face, DVec3 point);

/// Depth of a point inside a convex polygon of this plane: the least height over its edges [m],
/// negative outside.
double depth_inside(PolygonView polygon, DVec3 normal, DVec3 point);

}  // namespace luxel::hierarchical
