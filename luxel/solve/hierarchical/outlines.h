// Corners on the borders of leaves, so that neighbours have the same ones: no T-vertices.
#pragma once

#include <unordered_map>

#include "luxel/solve/hierarchical/tree.h"

namespace luxel::hierarchical {

/// Points that can be asked for along an edge.
class EdgePoints {
 public:
  explicit EdgePoints(double slack_m) : slack_m_(slack_m) {}
  void add(DVec3 p) { points_.push_back(p); }
  /// Call after the last add(): points within the slack of each other become one.
  void sort();
  /// The points within the slack of the edge, more than the slack away from its ends, in order from
  /// a to b.
  std::vector<DVec3> along(DVec3 a, DVec3 b) const;

 private:
  double slack_m_;
  std::vector<DVec3> points_;
};

/// Numbers of places: those within the slack of each other have one.
class Welder {
 public:
  explicit Welder(double slack_m) : slack_m_(slack_m) {}
  /// The number of the place; a new one is added to `places`.
  uint32_t index_of(DVec3 p, std::vector<DVec3>& places);

 private:
  double slack_m_;
  std::unordered_map<uint64_t, std::vector<uint32_t>> cells_;
};

}  // namespace luxel::hierarchical
