#include "luxel/viewfactor/merge_polygons.h"

#include <algorithm>
#include <bit>
#include <deque>
#include <optional>
#include <unordered_map>

#include "luxel/base/random.h"

namespace luxel::viewfactor {
namespace {

constexpr uint32_t kNone = ~0u;

struct HashOfPoint {
  size_t operator()(const std::array<double, 3>& p) const {
    uint64_t h = 0;
    for (const double x : p) h = hash64(h, std::bit_cast<uint64_t>(x));
    return size_t(h);
  }
};

/// Corners with equal coordinates are one.
struct Corners {
  std::vector<DVec3> position;
  std::unordered_map<std::array<double, 3>, uint32_t, HashOfPoint> known;

  uint32_t index_of(DVec3 p) {
    // Adding 0 makes -0 to 0, which compares equal and is to be the same corner.
    const std::array<double, 3> key{p.x + 0.0, p.y + 0.0, p.z + 0.0};
    const auto [it, is_new] = known.try_emplace(key, uint32_t(position.size()));
    if (is_new) position.push_back(p);
    return it->second;
  }
};

/// A convex polygon that grows: triangle k at first, with the half-edges 3 k to 3 k + 2.
struct MergedFace {
  uint32_t merged_into = kNone;
  uint32_t any_edge = 0;  ///< of its outline
  DVec3 area;             ///< vector, the sum over its triangles
  Plane plane;            ///< all corners lie within the slack of it
  double plane_area = 0;  ///< of the part that the plane was made from
};

/// The half-edges of all faces. An edge runs from its corner to that of the next one around its
/// face; its twin runs back along a face of the same plane.
struct HalfEdge {
  uint32_t corner = 0, next = 0, previous = 0, twin = kNone;
  bool gone = false;
};

struct Merging {
  Corners corners;
  std::vector<HalfEdge> edges;
  std::vector<MergedFace> faces;
  double slack = 0;

  DVec3 at(uint32_t edge) const { return corners.position[edges[edge].corner]; }
  uint32_t face_of(uint32_t edge) {
    uint32_t face = edge / 3;
    while (faces[face].merged_into != kNone) {
      const uint32_t above = faces[face].merged_into;
      if (faces[above].merged_into != kNone) faces[face].merged_into = faces[above].merged_into;
      face = above;
    }
    return face;
  }
  template <class Visit>
  bool all_corners(uint32_t face, const Visit& visit) const {
    uint32_t edge = faces[face].any_edge;
    do {
      if (!visit(at(edge))) return false;
      edge = edges[edge].next;
    } while (edge != faces[face].any_edge);
    return true;
  }
  bool lies_in(uint32_t face, const Plane& plane) const {
    return all_corners(face, [&](DVec3 p) { return std::abs(plane.height(p)) <= slack; });
  }
  /// The plane of the larger one decides: that of a small one is not known well enough far away.
  bool same_plane(uint32_t f, uint32_t g) const {
    const Plane &pf = faces[f].plane, &pg = faces[g].plane;
    if (dot(pf.normal, pg.normal) < 0.9999) return false;
    return dot(faces[f].area, faces[f].area) >= dot(faces[g].area, faces[g].area) ? lies_in(g, pf)
                                                                                  : lies_in(f, pg);
  }
};

/// False when the triangle has no area.
bool add_triangle(const std::array<DVec3, 3>& triangle, Merging& m) {
  const Plane plane = plane_of(triangle);
  if (plane.normal == DVec3{}) return false;
  const uint32_t first = uint32_t(m.edges.size());
  for (uint32_t k = 0; k < 3; ++k)
    m.edges.push_back({m.corners.index_of(triangle[k]), first + (k + 1) % 3, first + (k + 2) % 3});
  const DVec3 area = area_vector(triangle);
  m.faces.push_back({kNone, first, area, plane, length(area)});
  return true;
}

/// Makes twins of edges between the same corners in opposite directions, in one plane. Where more
/// than two faces of a plane meet, the first that fit.
Status find_twins(Merging& m, const Progress& progress) {
  constexpr int kMostCandidates = 64;  // so that an edge shared by thousands costs no square
  std::unordered_map<uint64_t, uint32_t> last;  // edge without twin, per pair of corners
  std::vector<uint32_t> before(m.edges.size(), kNone);
  const auto key = [](uint32_t from, uint32_t to) { return uint64_t(from) << 32 | to; };
  for (uint32_t e = 0; e < m.edges.size(); ++e) {
    LUXEL_TRY_STATUS(stopped(progress));
    const uint32_t from = m.edges[e].corner, to = m.edges[m.edges[e].next].corner;
    if (const auto opposite = last.find(key(to, from)); opposite != last.end()) {
      uint32_t* link = &opposite->second;
      for (int k = 0; k < kMostCandidates && *link != kNone; ++k, link = &before[*link]) {
        const uint32_t t = *link;
        if (!m.same_plane(e / 3, t / 3)) continue;
        m.edges[e].twin = t, m.edges[t].twin = e;
        *link = before[t];
        break;
      }
    }
    if (m.edges[e].twin != kNone) continue;
    const auto [same, is_new] = last.try_emplace(key(from, to), e);
    if (!is_new) before[e] = std::exchange(same->second, e);
  }
  return {};
}

/// Turn of the outline at a corner.
enum class Turn { left, straight, right };
Turn turn_at(DVec3 before, DVec3 at, DVec3 after, DVec3 normal, double slack) {
  const DVec3 chord = after - before;
  // The height of the corner over the chord of its neighbours, positive outside.
  const double height = dot(cross(at - before, chord), normal), limit = slack * length(chord);
  if (height > limit) return Turn::left;
  // Back along the same line: a slit.
  return height >= -limit && dot(at - before, after - at) > 0 ? Turn::straight : Turn::right;
}

/// Takes out the corner between edge `in` and the next one, where nothing but one other face of the
/// same plane meets this one any more: the corner lies on their straight common edge.
void straighten_shared(uint32_t in, Merging& m) {
  const uint32_t out = m.edges[in].next;
  const uint32_t back = m.edges[in].twin, forth = m.edges[out].twin;
  if (back == kNone || forth == kNone || m.edges[forth].next != back) return;
  for (const uint32_t e : {in, forth})  // a triangle keeps its corners
    if (m.edges[m.edges[m.edges[e].next].next].next == e) return;
  const DVec3 before = m.at(in), at = m.at(out), after = m.at(m.edges[out].next);
  if (turn_at(before, at, after, m.faces[m.face_of(in)].plane.normal, m.slack) != Turn::straight)
    return;
  for (const uint32_t e : {in, forth}) {
    HalfEdge& edge = m.edges[e];
    m.edges[edge.next].gone = true;
    edge.next = m.edges[edge.next].next;
    m.edges[edge.next].previous = e;
    m.faces[m.face_of(e)].any_edge = e;
  }
  m.edges[in].twin = forth, m.edges[forth].twin = in;
}

/// The plane becomes better known as the face grows: from twice the area it is made anew.
void renew_plane(uint32_t f, Merging& m) {
  MergedFace& face = m.faces[f];
  const double area = length(face.area);
  if (area < 2 * face.plane_area) return;
  face.plane_area = area;
  DVec3 sum;
  double count = 0;
  m.all_corners(f, [&](DVec3 p) {
    sum += p, count += 1;
    return true;
  });
  const DVec3 normal = normalize(face.area);
  const Plane plane{normal, dot(normal, sum * (1 / count))};
  if (m.lies_in(f, plane)) face.plane = plane;
}

/// Joins the face of an edge with the one across it, when the union is convex. What they share is
/// this edge alone: other corners on it are gone. Returns the edges at whose ends the outline
/// changed.
std::optional<std::array<uint32_t, 4>> join(uint32_t edge, Merging& m) {
  const uint32_t twin = m.edges[edge].twin;
  const uint32_t f = m.face_of(edge), g = m.face_of(twin);
  if (f == g) return std::nullopt;
  const uint32_t f_in = m.edges[edge].previous, f_out = m.edges[edge].next;
  const uint32_t g_in = m.edges[twin].previous, g_out = m.edges[twin].next;
  const DVec3 normal = m.faces[f].plane.normal;
  // The two corners at which the faces meet must not turn inwards.
  const auto stays_convex = [&](uint32_t in, uint32_t out) {
    return turn_at(m.at(in), m.at(out), m.at(m.edges[out].next), normal, m.slack) != Turn::right;
  };
  if (!stays_convex(f_in, g_out) || !stays_convex(g_in, f_out) || !m.same_plane(f, g))
    return std::nullopt;
  // One outline: past the shared edge each face goes on in the other.
  m.edges[edge].gone = m.edges[twin].gone = true;
  m.edges[f_in].next = g_out, m.edges[g_out].previous = f_in;
  m.edges[g_in].next = f_out, m.edges[f_out].previous = g_in;
  // One face, with the plane of the larger one.
  MergedFace &face = m.faces[f], &other = m.faces[g];
  if (other.plane_area > face.plane_area)
    face.plane = other.plane, face.plane_area = other.plane_area;
  face.area += other.area;
  face.any_edge = f_in;
  other.merged_into = f;
  renew_plane(f, m);
  straighten_shared(f_in, m);
  straighten_shared(g_in, m);
  return std::array{f_in, g_out, g_in, f_out};
}

/// Joins a face with its neighbours as long as one fits. An edge that did not go has to be looked
/// at again only when the outline changes at its ends.
Status grow(uint32_t face, Merging& m, const Progress& progress) {
  std::deque<uint32_t> open{3 * face, 3 * face + 1, 3 * face + 2};
  while (!open.empty()) {
    LUXEL_TRY_STATUS(stopped(progress));
    const uint32_t edge = open.front();
    open.pop_front();
    if (m.edges[edge].gone || m.edges[edge].twin == kNone) continue;
    if (const auto changed = join(edge, m))
      open.insert(open.end(), changed->begin(), changed->end());
  }
  return {};
}

/// The face's polygon without corners on straight edges.
Polygon straightened(uint32_t face, const Merging& m) {
  Polygon outline;
  m.all_corners(face, [&](DVec3 p) {
    outline.push_back(p);
    return true;
  });
  // The corner that lies farthest from another one is not on a straight edge: start there.
  const auto nearer = [from = outline[0]](DVec3 p, DVec3 q) {
    return dot(p - from, p - from) < dot(q - from, q - from);
  };
  std::rotate(outline.begin(), std::max_element(outline.begin(), outline.end(), nearer),
              outline.end());
  Polygon polygon;
  size_t left = outline.size();
  for (size_t i = 0; i < outline.size(); ++i) {
    const DVec3 after = outline[(i + 1) % outline.size()];
    if (!polygon.empty() && left > 3) {
      const DVec3 chord = after - polygon.back();
      if (length(cross(outline[i] - polygon.back(), chord)) <= m.slack * length(chord)) {
        --left;
        continue;
      }
    }
    polygon.push_back(outline[i]);
  }
  return polygon;
}

}  // namespace

Result<MergedPolygons> merge_polygons(std::span<const std::array<DVec3, 3>> triangles, double slack,
                                      Progress& progress) {
  MergedPolygons out;
  out.of_triangle.assign(triangles.size(), kNoPolygon);
  std::vector<uint32_t> triangle_of;  // per face
  Merging m;
  m.slack = slack;
  for (uint32_t t = 0; t < triangles.size(); ++t) {
    LUXEL_TRY_STATUS(stopped(progress));
    if (add_triangle(triangles[t], m)) triangle_of.push_back(t);
  }
  LUXEL_TRY_STATUS(find_twins(m, progress));
  for (uint32_t f = 0; f < m.faces.size(); ++f) {
    if (m.faces[f].merged_into == kNone) LUXEL_TRY_STATUS(grow(f, m, progress));
    progress.advance(1);
  }
  progress.advance(triangles.size() - m.faces.size());  // those without area
  std::vector<uint32_t> polygon_of(m.faces.size());
  for (uint32_t f = 0; f < m.faces.size(); ++f) {
    LUXEL_TRY_STATUS(stopped(progress));
    if (m.faces[f].merged_into != kNone) continue;
    polygon_of[f] = uint32_t(out.polygons.size());
    out.polygons.push_back(straightened(f, m));
  }
  for (uint32_t f = 0; f < m.faces.size(); ++f)
    out.of_triangle[triangle_of[f]] = polygon_of[m.face_of(3 * f)];
  return out;
}

}  // namespace luxel::viewfactor
