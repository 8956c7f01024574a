// Facts about the selected parts of a hierarchical solution, in numbers. [Hardt96, appendix B.4.6]
#pragma once

#include <string>
#include <vector>

#include "luxel/view/hierarchical/pick.h"

namespace luxel::view {

/// An element or a cluster, from the light there is.
struct NodeFacts {
  uint32_t id = 0;
  bool is_cluster = false;
  std::string name;        ///< of the instance and the material; of a cluster none
  size_t depth = 0;        ///< elements above it in its tree; of a cluster: clusters
  size_t height = 0;       ///< divisions below it, at most; of a cluster not counted
  size_t leaves = 0;       ///< below it, itself included; of a cluster: faces' elements
  double area_m2 = 0;      ///< of all surfaces below
  Rgb irradiance;          ///< E, a mean over all its links and all above [W/m^2]; elements
  Rgb radiosity;           ///< B, a mean; of a cluster: over all surfaces below
  Rgb reflectance;         ///< of elements
  size_t links = 0;        ///< that end here
  size_t links_above = 0;  ///< that end at what holds it
  Rgb over_links;          ///< E over the links that end here, of elements
  double most_error = 0, sum_of_errors = 0;  ///< of those links, as error_of() has it [W/m^2]
  size_t over_eps = 0;                       ///< of those links, how many err by more than eps
  double eps = 0;                            ///< of links [W/m^2]
};
/// `path` is path_to() a place; the node is its member `level`.
NodeFacts facts_of(const SolutionView& view, std::span<const uint32_t> path, size_t level);

/// A link between two elements or clusters.
struct LinkFacts {
  std::string receiver, source;    ///< what they are, in words
  bool is_far = false;             ///< one of them is a cluster: no polygons, no shaft
  double distance_m = 0;           ///< between the middles
  double form_factor = 0;          ///< mean, of what is visible; far: E per W that is sent [1/m^2]
  double visible = 1;              ///< share of the exchange, were nothing in between
  Rgb irradiance;                  ///< that it brings [W/m^2]
  double error = 0, eps = 0;       ///< [W/m^2]
  std::vector<uint32_t> blockers;  ///< faces that reach into the shaft
  bool is_crowded = false;         ///< more than points look at: rays decide
};
LinkFacts facts_of(const SolutionView& view, const LinkNumber& link);

/// A triangle of the light mesh.
struct TriangleFacts {
  std::array<DVec3, 3> corner;  ///< [m]
  std::array<Rgb, 6> value;     ///< E at corners and middles: interpolant_of() [W/m^2]
  double area_m2 = 0;
  uint32_t leaf = 0;      ///< of the tree's elements
  size_t line_edges = 0;  ///< edges that lie on discontinuities
  float bend = 0;         ///< how far middles of edges are from linear, at most
};
/// The mesh must be there.
TriangleFacts triangle_facts(const SolutionView& view, uint32_t triangle);

/// Corners of a polygon that make a discontinuity: a vertex, or the two ends of an edge.
struct Generator {
  DVec3 from, to;  ///< the same of a vertex
  bool is_edge() const { return !(from == to); }
};

/// A discontinuity and what makes it.
struct DiscontinuityFacts {
  hierarchical::Discontinuity line;
  uint32_t receiver = 0;  ///< a face
  /// Order of the discontinuity: 0 light itself jumps, 1 its slope, 2 its curvature. [Heckbert92]
  int degree = 2;
  double weight = 0;                                             ///< as weight_of() has it
  hierarchical::Ranking ranking = hierarchical::Ranking::slope;  ///< says the weight's unit
  std::string source, blocker;                                   ///< in words; empty: there is none
  std::optional<Generator> at_source, at_blocker;
};
/// A discontinuity of this face.
DiscontinuityFacts facts_of(const SolutionView& view, uint32_t receiver,
                            const hierarchical::Discontinuity& discontinuity);

/// "box, white": instance and material of a face.
std::string name_of_face(const SolutionView& view, uint32_t face);

/// One number and the unit where all channels are alike, else three.
std::string text_of(Rgb light, const std::string& unit);
/// Sentences and numbers for a panel, one a line. `unit`: of E; `origin`: of the scene.
std::vector<std::string> lines_of(const NodeFacts& facts, const std::string& unit);
std::vector<std::string> lines_of(const LinkFacts& facts, const std::string& unit);
std::vector<std::string> lines_of(const TriangleFacts& facts, const std::string& unit,
                                  DVec3 origin);
std::vector<std::string> lines_of(const DiscontinuityFacts& facts, const std::string& unit,
                                  DVec3 origin);

}  // namespace luxel::view
