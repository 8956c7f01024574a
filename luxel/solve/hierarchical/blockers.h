// Faces that stand between two places.
#pragma once

#include "luxel/solve/hierarchical/tree.h"
#include "luxel/viewfactor/polygon_tree.h"

namespace luxel::hierarchical {

/// All faces as opaque polygons, by number of face.
struct Blockers {
  std::vector<viewfactor::Blocker> all;
  viewfactor::PolygonTree tree;
  double slack_m = 0;
};
/// Blockers from all faces, and the tree of their boxes.
Blockers make_blockers(const Faces& faces);

/// Faces that may hide parts of two convex polygons from each other, ascending: those that reach
/// into the shaft between them. [Haines94]
void find_between(const Blockers& blockers, PolygonView a, PolygonView b,
                  std::vector<uint32_t>& found);
/// Faces between two convex polygons, of those that are between the wholes that they are parts of.
void filter_between(const Blockers& blockers, PolygonView a, PolygonView b,
                    std::span<const uint32_t> known, std::vector<uint32_t>& found);

/// Faces that may hide parts of a convex polygon from a point, ascending.
void find_before(const Blockers& blockers, DVec3 point, PolygonView polygon,
                 std::vector<uint32_t>& found);

/// Faces whose boxes meet that of a polygon, ascending.
void find_near(const Blockers& blockers, PolygonView polygon, std::vector<uint32_t>& found);

/// Faces that pass within `slack_m` of a point, ascending.
void find_touching(const Blockers& blockers, DVec3 point, double slack_m,
                   std::vector<uint32_t>& found);

}  // namespace luxel::hierarchical
