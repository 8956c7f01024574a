#include "luxel/viewfactor/shadow_lines.h"

#include <algorithm>

namespace luxel::viewfactor {
namespace {

/// One receiver and one light.
struct Stage {
  Plane receiver;
  PolygonView light;
  double radius = 0;  ///< of the light
  double height = 0;  ///< of its highest corner
  double slack = 0;
};

DVec3 within(const Plane& plane, DVec3 direction) {
  return direction - plane.normal * dot(plane.normal, direction);
}

/// Where the shadow of `p`, a point of the edge p q, falls, measured along the line. Seen from a
/// corner that is no higher than p, the edge's shadow has no end.
double shadow_at(const Stage& stage, DVec3 corner, DVec3 p, DVec3 q, DVec3 along) {
  constexpr double kFarAway = 1e30;
  const double top = stage.receiver.height(corner), low = stage.receiver.height(p);
  if (low <= stage.slack) return dot(along, p);
  if (low < 0.999 * top) return dot(along, corner + (p - corner) * (top / (top - low)));
  const double rise = low - stage.receiver.height(q);
  const DVec3 level = rise > 0 ? p + (q - p) * ((low - top) / rise) : p;
  return dot(along, level - corner) > 0 ? kFarAway : -kFarAway;
}

/// The line of the edge p q, seen from the corner of the light.
void add_line(const Stage& stage, DVec3 p, DVec3 q, DVec3 corner, std::vector<ShadowLine>& lines) {
  const double hp = stage.receiver.height(p), hq = stage.receiver.height(q);
  const bool lies_on = std::max(hp, hq) <= stage.slack;
  if (!lies_on && std::min(hp, hq) >= stage.receiver.height(corner))
    return;  // no shadow falls down
  const DVec3 across = lies_on ? cross(q - p, stage.receiver.normal) : cross(q - p, corner - p);
  const DVec3 flat = within(stage.receiver, across);
  const double size = length(flat);
  if (!(size > 1e-12 * length(q - p) * std::max(length(corner - p), length(q - p)))) return;
  ShadowLine line;
  line.normal = flat * (1 / size);
  line.along = cross(stage.receiver.normal, line.normal);
  // A point of the plane of edge and corner that lies on the receiver: down its steepest line.
  const double slope = dot(across, stage.receiver.normal) / size;
  line.offset = dot(line.normal, p) + (lies_on ? 0 : slope * hp);
  const double at_p = shadow_at(stage, corner, p, q, line.along);
  const double at_q = shadow_at(stage, corner, q, p, line.along);
  line.begin = std::min(at_p, at_q), line.end = std::max(at_p, at_q);
  line.low = std::max(0.0, std::min(hp, hq));
  line.spread = 2 * stage.radius / std::max(1e-3 * stage.height, stage.height - line.low);
  lines.push_back(line);
}

void add_lines(const Stage& stage, const Blocker& blocker, std::vector<ShadowLine>& lines) {
  const Plane behind = plane_of(stage.light);
  Polygon part = clip_above(blocker.corners, stage.receiver, stage.slack);
  if (!part.empty()) part = clip_above(part, behind, stage.slack);
  for (size_t i = 0; i < part.size(); ++i) {
    const DVec3 p = part[i], q = part[(i + 1) % part.size()];
    const bool lies_on =
        std::max(stage.receiver.height(p), stage.receiver.height(q)) <= stage.slack;
    for (const DVec3& corner : stage.light) {
      add_line(stage, p, q, corner, lines);
      if (lies_on) break;  // all corners give this one
    }
  }
}

}  // namespace

ShadowLines shadow_lines(const Plane& receiver, PolygonView light,
                         std::span<const Blocker> blockers, std::span<const uint32_t> chosen,
                         double slack) {
  Stage stage{receiver, light, radius_about(mean_corner(light), light), 0, slack};
  for (const DVec3& corner : light) stage.height = std::max(stage.height, receiver.height(corner));
  std::vector<uint8_t> wanted(blockers.size(), 0);
  for (const uint32_t index : chosen) wanted[index] = 1;
  ShadowLines found;
  for (uint32_t i = 0; i < blockers.size(); ++i) {
    if (wanted[i]) add_lines(stage, blockers[i], found.lines);
    found.ends.push_back(uint32_t(found.lines.size()));
  }
  return found;
}

bool is_sharp(const ShadowLine& line, double size_m) {
  return line.low * std::min(1.0, line.spread) < 0.5 * size_m;
}

Chord chord_of(const ShadowLine& line, const Triangle& triangle, double slack) {
  std::array<double, 3> height;
  bool above = false, below = false;
  for (size_t k = 0; k < 3; ++k) {
    height[k] = dot(line.normal, triangle[k]) - line.offset;
    above |= height[k] > slack, below |= height[k] < -slack;
  }
  if (!(above && below)) return {};
  std::array<DVec3, 2> ends;
  size_t count = 0;
  for (size_t k = 0; k < 3; ++k) {
    const size_t next = (k + 1) % 3;
    const double h = height[k], g = height[next];
    if (((h > 0) != (g > 0)) && count < 2)
      ends[count++] = triangle[k] + (triangle[next] - triangle[k]) * (h / (h - g));
  }
  if (count < 2) return {};
  DVec3 from = ends[0], to = ends[1];
  double t0 = dot(line.along, from), t1 = dot(line.along, to);
  if (t0 > t1) std::swap(from, to), std::swap(t0, t1);
  const double begin = std::max(t0, line.begin), end = std::min(t1, line.end);
  if (!(end - begin > slack)) return {};
  const DVec3 step = (to - from) * (1 / (t1 - t0));
  return {from + step * (begin - t0), from + step * (end - t0), t1 - t0, false};
}

double narrowest_penumbra(const ShadowLines& lines, double radius_m) {
  double narrowest = INFINITY;
  for (const ShadowLine& line : lines.lines)
    narrowest = std::min(narrowest, line.low * std::min(1.0, line.spread) / radius_m);
  return narrowest;
}

}  // namespace luxel::viewfactor
