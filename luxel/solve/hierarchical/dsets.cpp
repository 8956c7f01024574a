#include "luxel/solve/hierarchical/dsets.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace luxel::hierarchical {
namespace {

/// A line without ends: its direction with angle in [0, pi), its distance from the origin.
struct Line {
  DVec2 direction;
  double offset = 0;
};
Line line_of(const Segment2& s) {
  const DVec2 d = s.b - s.a;
  DVec2 unit = d * (1 / length(d));
  if (unit.y < 0 || (unit.y == 0 && unit.x < 0)) unit = unit * -1;
  return {unit, cross(unit, s.a)};
}

bool on_line(const Line& line, const Segment2& s, double slack_m) {
  return std::abs(cross(line.direction, s.a) - line.offset) <= slack_m &&
         std::abs(cross(line.direction, s.b) - line.offset) <= slack_m;
}

/// Pieces of a line that overlap or touch, joined.
std::vector<ActiveLine> joined(std::vector<ActiveLine> pieces, const Line& line, double slack_m) {
  const auto at = [&](DVec2 p) { return dot(line.direction, p); };
  for (ActiveLine& p : pieces)
    if (at(p.piece.a) > at(p.piece.b)) std::swap(p.piece.a, p.piece.b);
  std::sort(pieces.begin(), pieces.end(), [&](const ActiveLine& p, const ActiveLine& q) {
    return at(p.piece.a) < at(q.piece.a);
  });
  std::vector<ActiveLine> out;
  for (const ActiveLine& p : pieces) {
    if (!out.empty() && at(p.piece.a) <= at(out.back().piece.b) + slack_m) {
      if (at(p.piece.b) > at(out.back().piece.b)) out.back().piece.b = p.piece.b;
      out.back().contact |= p.contact;
      out.back().weight = std::max(out.back().weight, p.weight);
      continue;
    }
    out.push_back(p);
  }
  // On one line exactly, so that neighbouring leaves cut it at the same places.
  const DVec2 foot = DVec2{line.direction.y, -line.direction.x} * -line.offset;
  for (ActiveLine& p : out) {
    p.piece.a = foot + line.direction * at(p.piece.a);
    p.piece.b = foot + line.direction * at(p.piece.b);
  }
  return out;
}

}  // namespace

FacePlane plane_coordinates(const Face& face) {
  size_t longest = 0;
  double most = 0;
  for (size_t k = 0; k < face.corners.size(); ++k)
    if (const double l = length(face.corners[(k + 1) % face.corners.size()] - face.corners[k]);
        l > most)
      most = l, longest = k;
  const DVec3 u =
      normalize(face.corners[(longest + 1) % face.corners.size()] - face.corners[longest]);
  return {viewfactor::mean_corner(face.corners), u, normalize(cross(face.plane.normal, u))};
}

bool clip_to(std::span<const DVec2> polygon, double least_m, Segment2& segment) {
  // The part of the segment above all edges, by its parameters where it crosses them.
  double t0 = 0, t1 = 1;
  const DVec2 d = segment.b - segment.a;
  for (size_t k = 0; k < polygon.size(); ++k) {
    const DVec2 edge = polygon[(k + 1) % polygon.size()] - polygon[k];
    const double size = length(edge);
    if (!(size > 0)) continue;
    const double inside = cross(edge, segment.a - polygon[k]) / size,
                 change = cross(edge, d) / size;
    if (std::abs(change) <= 1e-12 * length(d)) {
      if (inside <= least_m * 1e-3) return false;  // along the border, or outside
      continue;
    }
    if (change > 0) t0 = std::max(t0, -inside / change);
    if (change < 0) t1 = std::min(t1, -inside / change);
  }
  if (!((t1 - t0) * length(d) > least_m)) return false;
  const Segment2 all = segment;
  segment = {all.a + d * t0, all.a + d * t1};
  // A line that runs along the border within rounding is none inside.
  const DVec2 middle = (segment.a + segment.b) * 0.5;
  for (size_t k = 0; k < polygon.size(); ++k) {
    const DVec2 edge = polygon[(k + 1) % polygon.size()] - polygon[k];
    if (cross(edge, middle - polygon[k]) <= least_m * 1e-3 * length(edge)) return false;
  }
  return true;
}

std::vector<DSet> make_dsets(std::span<const Discontinuity> discontinuities, const FacePlane& plane,
                             double slack_m) {
  struct Item {
    uint32_t index;
    Segment2 segment;
    double length_m;
  };
  std::vector<Item> items;
  for (uint32_t k = 0; k < discontinuities.size(); ++k) {
    const Segment2 s{plane.to_plane(discontinuities[k].a), plane.to_plane(discontinuities[k].b)};
    items.push_back({k, s, length(s.b - s.a)});
  }
  // The direction of long ones is known best.
  std::stable_sort(items.begin(), items.end(),
                   [](const Item& a, const Item& b) { return a.length_m > b.length_m; });
  // Each joins the first line that it lies on, or begins one.
  std::vector<DSet> out;
  std::vector<Line> lines;
  for (const Item& item : items) {
    size_t found = lines.size();
    for (size_t k = 0; k < lines.size() && found == lines.size(); ++k)
      if (on_line(lines[k], item.segment, slack_m)) found = k;
    if (found == lines.size()) {
      lines.push_back(line_of(item.segment));
      out.push_back({item.segment, {}});
    }
    // The line reaches from the first end of its members to the last.
    DSet& set = out[found];
    set.members.push_back(item.index);
    const DVec2 d = lines[found].direction;
    if (dot(d, set.line.a) > dot(d, set.line.b)) std::swap(set.line.a, set.line.b);
    for (const DVec2 p : {item.segment.a, item.segment.b}) {
      if (dot(d, p) < dot(d, set.line.a)) set.line.a = p;
      if (dot(d, p) > dot(d, set.line.b)) set.line.b = p;
    }
  }
  return out;
}

std::vector<ActiveLine> choose_active(std::span<const Discontinuity> discontinuities,
                                      std::span<const double> weight, double least_weight,
                                      const FacePlane& plane,
                                      std::span<const std::vector<DVec2>> leaves,
                                      uint32_t max_per_leaf, double slack_m) {
  // Lines, and the discontinuities by falling weight.
  const std::vector<DSet> sets = make_dsets(discontinuities, plane, slack_m);
  std::vector<uint32_t> set_of(discontinuities.size());
  for (uint32_t s = 0; s < sets.size(); ++s)
    for (const uint32_t m : sets[s].members) set_of[m] = s;
  std::vector<uint32_t> order(discontinuities.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(),
                   [&](uint32_t a, uint32_t b) { return weight[a] > weight[b]; });
  std::vector<std::vector<uint32_t>> active_in(leaves.size());  // sets
  std::vector<std::vector<ActiveLine>> pieces(sets.size());
  for (const uint32_t d : order) {
    if (weight[d] < least_weight) break;
    const Segment2 s{plane.to_plane(discontinuities[d].a), plane.to_plane(discontinuities[d].b)};
    // The leaves that it crosses, if all of them have room for its line.
    std::vector<size_t> crossed;
    bool room = true;
    for (size_t leaf = 0; leaf < leaves.size() && room; ++leaf) {
      Segment2 inside = s;
      if (!clip_to(leaves[leaf], slack_m, inside)) continue;
      const auto& there = active_in[leaf];
      if (std::find(there.begin(), there.end(), set_of[d]) != there.end()) continue;
      room = there.size() < max_per_leaf;
      crossed.push_back(leaf);
    }
    if (!room) continue;
    for (const size_t leaf : crossed) active_in[leaf].push_back(set_of[d]);
    pieces[set_of[d]].push_back(
        {s, discontinuities[d].kind == DiscontinuityKind::contact, weight[d]});
  }
  // Pieces of a line that meet become one.
  std::vector<ActiveLine> out;
  for (size_t s = 0; s < sets.size(); ++s) {
    if (pieces[s].empty()) continue;
    const auto all = joined(std::move(pieces[s]), line_of(sets[s].line), slack_m);
    out.insert(out.end(), all.begin(), all.end());
  }
  return out;
}

}  // namespace luxel::hierarchical
