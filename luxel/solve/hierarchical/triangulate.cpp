#include "luxel/solve/hierarchical/triangulate.h"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <algorithm>
#include <cmath>

namespace luxel::hierarchical {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<uint32_t, Kernel>;
using FaceBase = CGAL::Constrained_triangulation_face_base_2<Kernel>;
using Structure = CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>;
using Delaunay =
    CGAL::Constrained_Delaunay_triangulation_2<Kernel, Structure, CGAL::Exact_predicates_tag>;

/// The point, or one that is there already within `least_m`.
DVec2 snapped(DVec2 p, double least_m, std::vector<DVec2>& points) {
  for (const DVec2& q : points)
    if (dot(p - q, p - q) <= least_m * least_m) return q;
  points.push_back(p);
  return p;
}

/// Twice the signed area.
double area2(DVec2 a, DVec2 b, DVec2 c) { return cross(b - a, c - a); }

/// On the outline's straight edges rounding leaves flat triangles outside of it: all three corners
/// on one edge.
bool is_flat(const Triangulation& t, const std::array<uint32_t, 3>& corners, double least_m) {
  double longest = 0;
  for (size_t k = 0; k < 3; ++k) {
    const DVec2 d = t.points[corners[(k + 1) % 3]] - t.points[corners[k]];
    longest = std::max(longest, dot(d, d));
  }
  return area2(t.points[corners[0]], t.points[corners[1]], t.points[corners[2]]) <=
         1e-3 * least_m * std::sqrt(longest);
}

}  // namespace

Triangulation triangulate(std::span<const DVec2> outline, std::span<const Segment2> lines,
                          double least_m) {
  // Corners that are near each other become one.
  std::vector<DVec2> points;
  std::vector<DVec2> border;
  for (const DVec2 p : outline) {
    const DVec2 q = snapped(p, least_m, points);
    if (border.empty() || q.x != border.back().x || q.y != border.back().y) border.push_back(q);
  }
  // Outline and lines are constraints.
  Delaunay mesh;
  const auto insert = [&](DVec2 a, DVec2 b) {
    if (a.x != b.x || a.y != b.y)
      mesh.insert_constraint(Kernel::Point_2(a.x, a.y), Kernel::Point_2(b.x, b.y));
  };
  for (size_t k = 0; k < border.size(); ++k) insert(border[k], border[(k + 1) % border.size()]);
  for (const Segment2& s : lines)
    insert(snapped(s.a, least_m, points), snapped(s.b, least_m, points));
  // Numbered corners, and the triangles that are not flat.
  Triangulation out;
  for (auto v = mesh.finite_vertices_begin(); v != mesh.finite_vertices_end(); ++v) {
    v->info() = uint32_t(out.points.size());
    out.points.push_back({v->point().x(), v->point().y()});
  }
  for (auto f = mesh.finite_faces_begin(); f != mesh.finite_faces_end(); ++f) {
    const std::array<uint32_t, 3> t{f->vertex(0)->info(), f->vertex(1)->info(),
                                    f->vertex(2)->info()};
    if (!is_flat(out, t, least_m)) out.triangles.push_back(t);
  }
  return out;
}

}  // namespace luxel::hierarchical
