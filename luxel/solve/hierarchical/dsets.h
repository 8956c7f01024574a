// The discontinuities that divide the leaves of a face, by rank. [Hardt96, section 5.5]
#pragma once

#include "luxel/base/vec2_double.h"
#include "luxel/solve/hierarchical/discontinuities.h"

namespace luxel::hierarchical {

/// Coordinates in a face's plane [m].
struct FacePlane {
  DVec3 origin, u, v;

  DVec2 to_plane(DVec3 p) const { return {dot(p - origin, u), dot(p - origin, v)}; }
  DVec3 from_plane(DVec2 p) const { return origin + u * p.x + v * p.y; }
};
/// Origin in the mean corner, u along the longest edge, u x v the normal.
FacePlane plane_coordinates(const Face& face);

struct Segment2 {
  DVec2 a, b;
};

/// A line with discontinuities: those that lie on it to within rounding [Hardt96, "DSet"].
struct DSet {
  Segment2 line;                  ///< from the first end of any to the last
  std::vector<uint32_t> members;  ///< of the discontinuities it was made from
};
/// Sets by falling length of their longest member; every discontinuity is in one. Points nearer
/// than `slack_m` to a line lie on it. [Hardt96, section 5.5]
std::vector<DSet> make_dsets(std::span<const Discontinuity> discontinuities, const FacePlane& plane,
                             double slack_m);

/// A piece of a line that is to be an edge of the mesh, in the plane's coordinates [m].
struct ActiveLine {
  Segment2 piece;
  bool contact = false;
  double weight = 0;
};
/// The pieces of lines that are to be edges of the mesh. The strongest discontinuities are made
/// active one after another, each in all leaves that it crosses or in none, so that no leaf's mesh
/// has a corner on another's edge; one is passed over when in some leaf more than `max_per_leaf`
/// lines would be active [Hardt96, section 5.5, maxLeafDSets]. `weight` per discontinuity; `leaves`
/// are polygons in the plane.
std::vector<ActiveLine> choose_active(std::span<const Discontinuity> discontinuities,
                                      std::span<const double> weight, double least_weight,
                                      const FacePlane& plane,
                                      std::span<const std::vector<DVec2>> leaves,
                                      uint32_t max_per_leaf, double slack_m);

/// The part of a segment inside a convex counter-clockwise polygon; false when it is shorter than
/// `least_m` or only touches.
bool clip_to(std::span<const DVec2> polygon, double least_m, Segment2& segment);

}  // namespace luxel::hierarchical
