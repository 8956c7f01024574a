// Lines and areas in space that show parts of a hierarchical solution. [Hardt96, appendix B.4]
#pragma once

#include <vector>

#include "luxel/display/lines.h"
#include "luxel/view/hierarchical/probe.h"
#include "luxel/view/hierarchical/selection_facts.h"

namespace luxel::view {

/// A triangle that is seen from both sides and lets light through.
struct Area {
  std::array<Vec3, 3> corner;  ///< [m]
  Rgb color;                   ///< display values
  float opacity = 0.5f;
};

/// Shapes drawn over a picture of the scene.
struct SelectionShapes {
  std::vector<display::Line> lines;
  std::vector<Area> areas;
};

/// An element's outline, yellow, and those of the four parts below it, grey; a cluster's box. With
/// the links that end there, if they are to be seen: white where all is visible, green where
/// something stands between.
void add_node(const SolutionView& view, uint32_t id, bool has_links, SelectionShapes& out);
/// Its ends yellow and blue; the link as add_node() has it; of elements the shaft, grey, and the
/// blockers in it, red.
void add_link(const SolutionView& view, const LinkNumber& link, SelectionShapes& out);
/// Its outline, yellow.
void add_triangle(const SolutionView& view, uint32_t triangle, SelectionShapes& out);
/// The line itself violet; its source yellow, its blocker red, its receiver blue; and the corner or
/// the edge of each that makes it, with the rays from there to both ends of the line.
void add_discontinuity(const SolutionView& view, const DiscontinuityFacts& facts,
                       SelectionShapes& out);
/// Outlines of sources violet, what of them is seen white with green edges; grey rays from the
/// point to the corners of what its horizon leaves.
void add_backprojection(const BackprojectionProbe& probe, SelectionShapes& out);

/// The edges of the convex hull of two convex polygons that lead from one to the other: the sides
/// of their shaft. [Haines94]
std::vector<std::array<DVec3, 2>> shaft_edges(hierarchical::PolygonView a,
                                              hierarchical::PolygonView b, double slack_m);

}  // namespace luxel::view
