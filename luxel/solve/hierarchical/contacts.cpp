#include "luxel/solve/hierarchical/contacts.h"

#include <algorithm>
#include <cmath>

#include "luxel/base/parallel.h"

namespace luxel::hierarchical {
namespace {

/// Lines per face. Every pair of lines may cross, so that 32 make some 500 pieces at most.
constexpr size_t kMostCuts = 32;
constexpr double kShort = 0.02;       ///< of a face's size: shorter contacts alone are none
constexpr double kShortCut = 2e-3;    ///< of a face's size
constexpr double kSmallPiece = 1e-4;  ///< of a face's area

bool meet_at_ends(const Segment& s, const Segment& t, double slack_m) {
  for (const DVec3& p : {s.a, s.b})
    for (const DVec3& q : {t.a, t.b})
      if (length(p - q) <= slack_m) return true;
  return false;
}

/// The long ones, and the short ones between them: the ends of a panel's foot.
void leave_out_short(double short_m, double slack_m, std::vector<Segment>& lines) {
  std::vector<Segment> kept;
  for (const Segment& s : lines)
    if (length(s.b - s.a) >= short_m ||
        std::any_of(lines.begin(), lines.end(), [&](const Segment& t) {
          return length(t.b - t.a) >= short_m && meet_at_ends(s, t, slack_m);
        }))
      kept.push_back(s);
  lines = std::move(kept);
}

/// The longest contacts first.
std::vector<Segment> lines_of_cuts(const Faces& faces, const Blockers& blockers, uint32_t index) {
  const Face& face = faces.faces[index];
  const double size_m = std::sqrt(viewfactor::area_m2(face.corners));
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
  leave_out_short(kShort * size_m, 8 * blockers.slack_m, out);
  std::stable_sort(out.begin(), out.end(), [](const Segment& a, const Segment& b) {
    return length(a.b - a.a) > length(b.b - b.a);
  });
  if (out.size() > kMostCuts) out.resize(kMostCuts);
  return out;
}

/// A piece in two. The better the rounder the thinner half is, and the fewer other lines are cut.
struct Cut {
  Polygon left, right;
  double score = 0;
};

/// The area over that of the square on the longest way through it.
double roundness(PolygonView p) {
  double longest = 0;
  for (const DVec3& a : p)
    for (const DVec3& b : p) longest = std::max(longest, dot(b - a, b - a));
  return viewfactor::area_m2(p) / longest;
}

/// All the lines of a face, and what is too small to be cut.
struct Cutter {
  DVec3 normal;
  std::vector<Segment> lines;
  double least_length_m = 0, least_area_m2 = 0, slack_m = 0;

  bool crosses(PolygonView piece, Segment other, const Plane& left) const {
    if (!clip_to(piece, normal, other)) return false;
    const double a = left.height(other.a), b = left.height(other.b);
    return std::min(a, b) < -least_length_m && std::max(a, b) > least_length_m;
  }

  /// Along the whole line of a segment; nothing where it does not run through the piece.
  Cut along(PolygonView piece, const Segment& segment) const {
    Segment inside = segment;
    if (!clip_to(piece, normal, inside) || length(inside.b - inside.a) <= least_length_m) return {};
    const DVec3 across = normalize(cross(normal, segment.b - segment.a));
    const Plane left{across, dot(across, segment.a)}, right{-across, -left.offset};
    Cut cut{viewfactor::clip_above(piece, left, slack_m),
            viewfactor::clip_above(piece, right, slack_m)};
    if (cut.left.empty() || cut.right.empty() ||
        std::min(viewfactor::area_m2(cut.left), viewfactor::area_m2(cut.right)) <= least_area_m2)
      return {};
    const auto crossed = std::count_if(lines.begin(), lines.end(), [&](const Segment& other) {
      return crosses(piece, other, left);
    });
    cut.score = std::min(roundness(cut.left), roundness(cut.right)) / double(1 + crossed);
    return cut;
  }

  /// A cut goes through the whole piece, so the best comes first: what stands in the middle of a
  /// floor would else leave strips as thin as itself from wall to wall.
  void cut(const Polygon& piece, std::vector<Polygon>& out) const {
    Cut best;
    for (const Segment& line : lines)
      if (Cut found = along(piece, line); found.score > best.score) best = std::move(found);
    if (best.left.empty()) {
      out.push_back(piece);
      return;
    }
    cut(best.left, out), cut(best.right, out);
  }
};

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
  if (!meet(face.plane, standing.plane, viewfactor::mean_corner(standing.corners),
            4 * (std::sqrt(viewfactor::area_m2(face.corners)) +
                 viewfactor::radius_about(face.corners[0], standing.corners)),
            line))
    return std::nullopt;
  Polygon grown;  // so that an edge in the plane is inside for certain
  const DVec3 middle = viewfactor::mean_corner(standing.corners);
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
      if (face.curved) {
        out[f] = {face.corners};
        continue;
      }
      const double area = viewfactor::area_m2(face.corners);
      Cutter{face.plane.normal, lines_of_cuts(faces, blockers, uint32_t(f)),
             kShortCut * std::sqrt(area), kSmallPiece * area, blockers.slack_m}
          .cut(face.corners, out[f]);
    }
  });
  return out;
}

}  // namespace luxel::hierarchical
