#include "luxel/solve/hierarchical/overlaps.h"

#include <fmt/format.h>

#include <algorithm>

#include "luxel/solve/hierarchical/segments.h"

namespace luxel::hierarchical {
namespace {

/// Overlaps smaller than this part of the smaller face are rounding.
constexpr double kLeastPart = 1e-4;
constexpr size_t kMostNamed = 3;

bool lie_on_each_other(const Face& f, const Face& g, double slack_m) {
  if (dot(f.plane.normal, g.plane.normal) < 1 - 1e-9) return false;
  for (const DVec3& p : g.corners)
    if (std::abs(f.plane.height(p)) > slack_m) return false;
  Polygon both = f.corners;
  for (size_t k = 0; k < g.corners.size() && !both.empty(); ++k) {
    const DVec3 edge = g.corners[(k + 1) % g.corners.size()] - g.corners[k];
    const DVec3 inwards = normalize(cross(g.plane.normal, edge));
    both = viewfactor::clip_above(both, {inwards, dot(inwards, g.corners[k])}, slack_m);
  }
  const double least = std::min(viewfactor::area_m2(f.corners), viewfactor::area_m2(g.corners));
  return !both.empty() && viewfactor::area_m2(both) > kLeastPart * least;
}

bool straddles(const Face& f, const Plane& plane, double slack_m) {
  bool above = false, below = false;
  for (const DVec3& p : f.corners)
    above |= plane.height(p) > slack_m, below |= plane.height(p) < -slack_m;
  return above && below;
}

bool pass_through(const Face& f, const Face& g, double slack_m) {
  if (!straddles(f, g.plane, slack_m) || !straddles(g, f.plane, slack_m)) return false;
  const DVec3 middle = viewfactor::mean_corner(f.corners);
  const double reach = 4 * (viewfactor::radius_about(middle, f.corners) +
                            viewfactor::radius_about(middle, g.corners));
  Segment line;
  return meet(f.plane, g.plane, middle, reach, line) && clip_to(f.corners, f.plane.normal, line) &&
         clip_to(g.corners, g.plane.normal, line) && length(line.b - line.a) > 4 * slack_m;
}

/// "A and B, C and D and 5 more pairs of faces lie on each other"
struct Found {
  size_t count = 0;
  std::string names;

  void add(const scene::Scene& scene, const Face& f, const Face& g) {
    if (count++ >= kMostNamed) return;
    names += fmt::format("{}'{}' and '{}'", names.empty() ? "" : ", ",
                         scene.instances[f.instance].name, scene.instances[g.instance].name);
  }
  std::string text() const {
    return count > kMostNamed ? fmt::format("{} and {} more pairs", names, count - kMostNamed)
                              : names;
  }
};

}  // namespace

std::vector<std::string> overlap_warnings(const scene::Scene& scene, const Faces& faces,
                                          const Blockers& blockers) {
  Found on, through;
  std::vector<uint32_t> near;
  for (uint32_t f = 0; f < faces.size(); ++f) {
    find_near(blockers, faces.faces[f].corners, near);
    for (const uint32_t g : near) {
      if (g <= f) continue;
      const Face &a = faces.faces[f], &b = faces.faces[g];
      if (lie_on_each_other(a, b, faces.slack_m)) on.add(scene, a, b);
      if (pass_through(a, b, faces.slack_m)) through.add(scene, a, b);
    }
  }
  std::vector<std::string> out;
  if (on.count > 0)
    out.push_back("faces coincide, so it is arbitrary which one is lit: " + on.text());
  if (through.count > 0)
    out.push_back("faces intersect, and the light inside them is meaningless: " + through.text());
  return out;
}

}  // namespace luxel::hierarchical
