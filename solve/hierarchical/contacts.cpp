#include "solve/hierarchical/contacts.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"

namespace luxel::hierarchical {
namespace {

constexpr size_t kMostCuts = 32;
constexpr double kShortCut = 0.02;    ///< of a face's size
constexpr double kSmallPiece = 1e-4;  ///< of a face's area

/// The longest contacts first.
std::vector<Segment> lines_of_cuts(const Faces& faces, const Blockers& blockers, uint32_t index) {
  const Face& face = faces.faces[index];
  const double size_m = std::sqrt(transport::area_m2(face.corners));
  std::vector<uint32_t> near;
  find_near(blockers, face.corners, near);
  std::vector<Segment> out;
  for (const uint32_t other : near) {
    if (other == index || faces.faces[other].curved) continue;
    const auto line = contact_of(faces, index, other, blockers.slack_m);
    if (!line || length(line->b - line->a) < kShortCut * size_m) continue;
    const DVec3 middle = (line->a + line->b) * 0.5;
    if (depth_inside(face.corners, face.plane.normal, middle) > 1e-3 * size_m) out.push_back(*line);
  }
  std::stable_sort(out.begin(), out.end(), [](const Segment& a, const Segment& b) {
    return length(a.b - a.a) > length(b.b - b.a);
  });
  if (out.size() > kMostCuts) out.resize(kMostCuts);
  return out;
}

/// Cuts every piece that a segment runs through, along its whole line.
void cut(const Face& face, const Segment& segment, double slack_m, std::vector<Polygon>& pieces) {
  const DVec3 across = normalize(cross(face.plane.normal, segment.b - segment.a));
  const Plane left{across, dot(across, segment.a)}, right{-across, -left.offset};
  const double area = transport::area_m2(face.corners);
  std::vector<Polygon> out;
  for (const Polygon& piece : pieces) {
    Segment inside = segment;
    const Polygon a = transport::clip_above(piece, left, slack_m);
    const Polygon b = transport::clip_above(piece, right, slack_m);
    const bool is_cut = clip_to(piece, face.plane.normal, inside) &&
                        length(inside.b - inside.a) > kShortCut * std::sqrt(area) && !a.empty() &&
                        !b.empty() &&
                        std::min(transport::area_m2(a), transport::area_m2(b)) > kSmallPiece * area;
    if (!is_cut) {
      out.push_back(piece);
      continue;
    }
    out.push_back(a), out.push_back(b);
  }
  pieces = std::move(out);
}

}  // namespace

std::optional<Segment> contact_of(const Faces& faces, uint32_t index, uint32_t other,
                                  double slack_m) {
  const Face &face = faces.faces[index], &standing = faces.faces[other];
  if (length(cross(standing.plane.normal, face.plane.normal)) < 1e-9) return std::nullopt;
  double low = INFINITY, high = -INFINITY;
  for (const DVec3& p : standing.corners)
    low = std::min(low, face.plane.height(p)), high = std::max(high, face.plane.height(p));
  if (low > slack_m || high <= slack_m) return std::nullopt;  // above, or behind the front
  Segment line;
  if (!meet(face.plane, standing.plane, transport::mean_corner(standing.corners),
            4 * (std::sqrt(transport::area_m2(face.corners)) +
                 transport::radius_about(face.corners[0], standing.corners)),
            line))
    return std::nullopt;
  Polygon grown;  // so that an edge in the plane is inside for certain
  const DVec3 middle = transport::mean_corner(standing.corners);
  for (const DVec3& p : standing.corners)
    grown.push_back(p + normalize(p - middle) * (2 * slack_m));
  if (!clip_to(grown, standing.plane.normal, line) ||
      !clip_to(face.corners, face.plane.normal, line))
    return std::nullopt;
  return line;
}

std::vector<std::vector<Polygon>> cut_at_contacts(const Faces& faces, const Blockers& blockers) {
  std::vector<std::vector<Polygon>> out(faces.size());
  parallel_for(faces.size(), 16, [&](size_t begin, size_t end) {
    for (size_t f = begin; f < end; ++f) {
      const Face& face = faces.faces[f];
      out[f] = {face.corners};
      if (face.curved) continue;
      for (const Segment& line : lines_of_cuts(faces, blockers, uint32_t(f)))
        cut(face, line, blockers.slack_m, out[f]);
    }
  });
  return out;
}

}  // namespace luxel::hierarchical
