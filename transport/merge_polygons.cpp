#include "transport/merge_polygons.h"

#include <algorithm>
#include <map>
#include <optional>
#include <tuple>

namespace luxel::transport {
namespace {

/// A polygon as indices of corners.
struct Outline {
  std::vector<uint32_t> corners;
  Plane plane;
};

/// Corners with equal coordinates are one.
struct Corners {
  std::vector<DVec3> position;
  std::map<std::tuple<double, double, double>, uint32_t> known;

  uint32_t index_of(DVec3 p) {
    // -0 and 0 compare equal, which is wanted.
    const auto [it, is_new] = known.try_emplace({p.x, p.y, p.z}, uint32_t(position.size()));
    if (is_new) position.push_back(p);
    return it->second;
  }
};

using Edge = std::pair<uint32_t, uint32_t>;
using EdgeOwners = std::map<Edge, uint32_t>;

void own_edges(const Outline& outline, uint32_t owner, EdgeOwners& owners) {
  const size_t count = outline.corners.size();
  for (size_t i = 0; i < count; ++i)
    owners[{outline.corners[i], outline.corners[(i + 1) % count]}] = owner;
}

bool same_plane(const Outline& a, const Outline& b, const Corners& corners, double slack) {
  if (dot(a.plane.normal, b.plane.normal) < 0.9999) return false;
  const auto lies_in = [&](const Outline& outline, const Plane& plane) {
    return std::all_of(outline.corners.begin(), outline.corners.end(), [&](uint32_t c) {
      return std::abs(plane.height(corners.position[c])) <= slack;
    });
  };
  return lies_in(a, b.plane) && lies_in(b, a.plane);
}

/// True where the outline turns left or goes straight on to within `slack`.
bool is_convex_at(const Outline& outline, size_t i, const Corners& corners, double slack) {
  const size_t count = outline.corners.size();
  const DVec3 before = corners.position[outline.corners[(i + count - 1) % count]];
  const DVec3 at = corners.position[outline.corners[i]];
  const DVec3 after = corners.position[outline.corners[(i + 1) % count]];
  const DVec3 chord = after - before;
  // The height of the corner over the chord of its neighbours, positive outside.
  const double height = dot(cross(at - before, chord), outline.plane.normal);
  return height >= -slack * length(chord);
}

/// The union of two outlines that share the edge (from, to) of `a`: nothing unless what they share
/// is one chain of edges and the corners at its ends are convex.
std::optional<Outline> joined(const Outline& a, const Outline& b, Edge shared,
                              const Corners& corners, double slack) {
  const size_t na = a.corners.size(), nb = b.corners.size();
  size_t end_a = 0, end_b = 0;  // positions of shared.second in a, and in b
  while (a.corners[end_a] != shared.second) ++end_a;
  while (b.corners[end_b] != shared.second) ++end_b;
  // Extend the chain: forwards along a is backwards along b.
  size_t length = 1;
  while (length + 1 < std::min(na, nb) &&
         a.corners[(end_a + 1) % na] == b.corners[(end_b + nb - 1) % nb]) {
    end_a = (end_a + 1) % na, end_b = (end_b + nb - 1) % nb, ++length;
  }
  while (length + 1 < std::min(na, nb) &&
         a.corners[(end_a + 2 * na - length - 1) % na] == b.corners[(end_b + length + 1) % nb])
    ++length;
  // From the chain's end once around a to its start, then around b back to the end.
  Outline outline{{}, a.plane};
  for (size_t i = 0; i + length < na; ++i) outline.corners.push_back(a.corners[(end_a + i) % na]);
  const size_t start = outline.corners.size();
  for (size_t i = 0; i + length < nb; ++i)
    outline.corners.push_back(b.corners[(end_b + length + i) % nb]);
  if (outline.corners.size() < 3) return std::nullopt;
  if (!is_convex_at(outline, 0, corners, slack) || !is_convex_at(outline, start, corners, slack))
    return std::nullopt;
  // A corner twice: the outlines touch elsewhere too.
  std::vector<uint32_t> sorted = outline.corners;
  std::sort(sorted.begin(), sorted.end());
  if (std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end()) return std::nullopt;
  return outline;
}

/// Joins outline `i` with neighbours as long as one fits.
bool grow(uint32_t i, std::vector<Outline>& outlines, EdgeOwners& owners, const Corners& corners,
          double slack) {
  bool grown = false;
  for (size_t k = 0; k < outlines[i].corners.size(); ++k) {
    const std::vector<uint32_t>& around = outlines[i].corners;
    const Edge edge{around[k], around[(k + 1) % around.size()]};
    const auto twin = owners.find({edge.second, edge.first});
    if (twin == owners.end() || twin->second == i) continue;
    Outline& other = outlines[twin->second];
    if (!same_plane(outlines[i], other, corners, slack)) continue;
    std::optional<Outline> whole = joined(outlines[i], other, edge, corners, slack);
    if (!whole) continue;
    for (const Outline* part : {&outlines[i], &other})
      for (size_t c = 0; c < part->corners.size(); ++c)
        owners.erase({part->corners[c], part->corners[(c + 1) % part->corners.size()]});
    other.corners.clear();
    outlines[i] = std::move(*whole);
    own_edges(outlines[i], i, owners);
    grown = true;
    k = size_t(-1);  // from the start
  }
  return grown;
}

/// The outline's polygon without corners on straight edges.
Polygon straightened(const Outline& outline, const Corners& corners, double slack) {
  Polygon polygon;
  for (const uint32_t c : outline.corners) polygon.push_back(corners.position[c]);
  for (size_t i = 0; i < polygon.size() && polygon.size() > 3;) {
    const size_t count = polygon.size();
    const DVec3 before = polygon[(i + count - 1) % count], after = polygon[(i + 1) % count];
    const DVec3 chord = after - before;
    if (length(cross(polygon[i] - before, chord)) <= slack * length(chord))
      polygon.erase(polygon.begin() + long(i));
    else
      ++i;
  }
  return polygon;
}

}  // namespace

std::vector<Polygon> merge_polygons(std::span<const std::array<DVec3, 3>> triangles, double slack) {
  Corners corners;
  std::vector<Outline> outlines;
  EdgeOwners owners;
  for (const std::array<DVec3, 3>& triangle : triangles) {
    Outline outline{{}, plane_of(triangle)};
    for (const DVec3& p : triangle) outline.corners.push_back(corners.index_of(p));
    if (outline.plane.normal == DVec3{}) continue;
    own_edges(outline, uint32_t(outlines.size()), owners);
    outlines.push_back(std::move(outline));
  }
  for (bool grown = true; grown;) {
    grown = false;
    for (uint32_t i = 0; i < outlines.size(); ++i)
      if (!outlines[i].corners.empty()) grown |= grow(i, outlines, owners, corners, slack);
  }
  std::vector<Polygon> polygons;
  for (const Outline& outline : outlines)
    if (!outline.corners.empty()) polygons.push_back(straightened(outline, corners, slack));
  return polygons;
}

}  // namespace luxel::transport
