// Points are inserted one after the other, then constraints; flips of edges restore the Delaunay
// property after each. [Lawson77; Sloan93] Half-edges and the point at infinity as in [Guibas85].
#include "luxel/solve/hierarchical/constrained_delaunay.h"

#include <algorithm>
#include <cfloat>
#include <cmath>

#include "luxel/base/check.h"
#include "luxel/base/exact_predicates.h"

namespace luxel::hierarchical {
namespace {

/// A vertex that lies beyond all edges of the hull: with it every edge has a triangle on both
/// sides.
constexpr uint32_t kInfinity = 0;
constexpr uint32_t kNoHalfEdge = UINT32_MAX;

/// An edge as its left triangle has it. Each three in a row are a triangle, counter-clockwise.
struct HalfEdge {
  uint32_t from;  ///< vertex
  uint32_t twin;  ///< the half-edge of the triangle on the right
  bool fixed;     ///< part of a constraint
};

uint32_t next_half(uint32_t h) { return h % 3 == 2 ? h - 2 : h + 1; }
uint32_t last_half(uint32_t h) { return h % 3 == 0 ? h + 2 : h - 1; }

bool is_same(DVec2 a, DVec2 b) { return a.x == b.x && a.y == b.y; }

/// For p on the line through a and b: on b's side of a.
bool is_ahead(DVec2 a, DVec2 b, DVec2 p) {
  return a.x != b.x ? (p.x > a.x) == (b.x > a.x) : (p.y > a.y) == (b.y > a.y);
}

/// Wide enough for products of any two doubles.
using Wide = long double;
struct WideVec2 {
  Wide x, y;
};
WideVec2 difference(DVec2 a, DVec2 b) { return {Wide(a.x) - b.x, Wide(a.y) - b.y}; }
Wide cross(WideVec2 a, WideVec2 b) { return a.x * b.y - a.y * b.x; }
Wide square(WideVec2 a) { return a.x * a.x + a.y * a.y; }

/// p lies between a and b, within `slack` of their line, and nearer to both than they are to each
/// other.
bool is_between(DVec2 a, DVec2 b, DVec2 p, double slack) {
  const WideVec2 d = difference(b, a), to_p = difference(p, a);
  const Wide size2 = square(d);
  return square(to_p) < size2 && square(difference(p, b)) < size2 &&
         std::abs(cross(d, to_p)) <= slack * std::sqrt(size2);
}

/// Where ab and cd cross, rounded, within the boxes around both. Where rounding leaves nothing of
/// the angle between them, any point of the overlap will do.
DVec2 crossing_of(DVec2 a, DVec2 b, DVec2 c, DVec2 d) {
  const WideVec2 u = difference(b, a), v = difference(d, c);
  const Wide along = cross(difference(c, a), v) / cross(u, v);
  const Wide t = along > 0 ? std::min(along, Wide(1)) : 0;  // also for 0 / 0
  const auto within = [](Wide at, double a0, double b0, double c0, double d0) {
    return std::clamp(double(at), std::max(std::min(a0, b0), std::min(c0, d0)),
                      std::min(std::max(a0, b0), std::max(c0, d0)));
  };
  return {within(a.x + t * u.x, a.x, b.x, c.x, d.x), within(a.y + t * u.y, a.y, b.y, c.y, d.y)};
}

/// Its triangles are counter-clockwise and cover the hull, and no edge could be flipped that is not
/// fixed: between calls.
class DelaunayMesh {
 public:
  /// One triangle, counter-clockwise. Rounding moves crossings by less than `slack`.
  DelaunayMesh(DVec2 a, DVec2 b, DVec2 c, double slack, size_t most_cuts);

  /// Returns its vertex, which may be there already.
  uint32_t add_point(DVec2 p);
  /// Vertices.
  void add_constraint(uint32_t from, uint32_t to);
  Triangulation triangles() const;

 private:
  /// The way from a vertex to another, up to the first of three things.
  struct Way {
    std::vector<uint32_t> left = {};  ///< up to a vertex on it, with those just left of it
    uint32_t beside = kInfinity;      ///< a vertex so near that rounding may decide its side
    uint32_t across = kNoHalfEdge;    ///< of a constraint
  };

  uint32_t to(uint32_t h) const { return halves_[next_half(h)].from; }
  uint32_t apex(uint32_t h) const { return halves_[last_half(h)].from; }
  int turn(uint32_t a, uint32_t b, uint32_t c) const {
    return b == c ? 0 : orientation(points_[a], points_[b], points_[c]);
  }

  int side(uint32_t h, DVec2 p) const;
  bool is_beyond(uint32_t h, DVec2 p) const;
  bool is_encroached(uint32_t h) const;
  uint32_t locate(DVec2 p) const;
  uint32_t half_between(uint32_t a, uint32_t b) const;
  bool leads_to(uint32_t h, uint32_t b) const;
  Way way_to(uint32_t a, uint32_t b) const;

  void join(uint32_t h, uint32_t from, uint32_t twin, uint32_t twin_from);
  void put(uint32_t h, const HalfEdge& half);
  void set_fixed(uint32_t h, bool fixed);
  void flip(uint32_t h);
  void split(uint32_t h, DVec2 p);
  void cut_ear(uint32_t u, uint32_t v, uint32_t w);
  void clear(std::span<const uint32_t> left);
  uint32_t cut(uint32_t h, uint32_t a, uint32_t b);
  void settle();

  std::vector<DVec2> points_;      ///< of vertices
  std::vector<uint32_t> half_of_;  ///< per vertex, one that begins there
  std::vector<HalfEdge> halves_;
  std::vector<uint32_t> doubtful_;  ///< half-edges that may have to be flipped
  uint32_t recent_ = 0;             ///< a half-edge near the last point
  double slack_;
  size_t cuts_left_;
};

DelaunayMesh::DelaunayMesh(DVec2 a, DVec2 b, DVec2 c, double slack, size_t most_cuts)
    : points_{{}, a, b, c},
      half_of_{5, 0, 1, 2},
      halves_(12),
      slack_(slack),
      cuts_left_(most_cuts) {
  for (uint32_t k = 0; k < 3; ++k) {
    const uint32_t begin = k + 1, end = (k + 1) % 3 + 1, outside = 3 + 3 * k;
    join(k, begin, outside, end);
    join(outside + 1, begin, 3 + 3 * ((k + 2) % 3) + 2, kInfinity);
  }
}

/// 1 where p lies left of the half-edge; edges to infinity have all on their left.
int DelaunayMesh::side(uint32_t h, DVec2 p) const {
  const uint32_t a = halves_[h].from, b = to(h);
  return a == kInfinity || b == kInfinity ? 1 : orientation(points_[a], points_[b], p);
}

/// For p outside of the half-edge's triangle. An edge of the hull belongs to the triangle within.
bool DelaunayMesh::is_beyond(uint32_t h, DVec2 p) const {
  return side(h, p) < (apex(h) == kInfinity ? 1 : 0);
}

/// In the circle through infinity lies what is left of the other two corners: the hull grows there.
bool DelaunayMesh::is_encroached(uint32_t h) const {
  const uint32_t a = halves_[h].from, b = to(h), c = apex(h), d = apex(halves_[h].twin);
  if (c == kInfinity || d == kInfinity) return false;
  if (a == kInfinity) return turn(b, c, d) > 0;
  if (b == kInfinity) return turn(c, a, d) > 0;
  return in_circle(points_[a], points_[b], points_[c], points_[d]) > 0;
}

/// A half-edge of the triangle that p lies in. Constraints may lead a walk in a circle: then all
/// triangles are asked.
uint32_t DelaunayMesh::locate(DVec2 p) const {
  const auto way_out = [&](uint32_t h) {
    for (int k = 0; k < 3; ++k, h = next_half(h))
      if (is_beyond(h, p)) return h;
    return kNoHalfEdge;
  };
  uint32_t h = recent_;
  for (size_t step = 0; step < halves_.size(); ++step) {
    const uint32_t out = way_out(h);
    if (out == kNoHalfEdge) return h;
    h = next_half(halves_[out].twin);
  }
  for (h = 0; h < halves_.size() && way_out(h) != kNoHalfEdge;) h += 3;
  LUXEL_CHECK(h < halves_.size());
  return h;
}

void DelaunayMesh::join(uint32_t h, uint32_t from, uint32_t twin, uint32_t twin_from) {
  halves_[h] = {from, twin, false};
  halves_[twin] = {twin_from, h, false};
}

/// Moves a half-edge to h. Its triangle is another now.
void DelaunayMesh::put(uint32_t h, const HalfEdge& half) {
  halves_[h] = half;
  halves_[half.twin].twin = h;
  half_of_[half.from] = h;
  doubtful_.push_back(h);
}

void DelaunayMesh::set_fixed(uint32_t h, bool fixed) {
  halves_[h].fixed = halves_[halves_[h].twin].fixed = fixed;
  doubtful_.push_back(h);
}

/// Makes h the other diagonal of the two triangles at it.
void DelaunayMesh::flip(uint32_t h) {
  const uint32_t g = halves_[h].twin;
  const uint32_t c = apex(h), d = apex(g);
  const std::array old{halves_[next_half(h)], halves_[last_half(h)], halves_[next_half(g)],
                       halves_[last_half(g)]};
  halves_[h].from = d, halves_[g].from = c;
  put(next_half(h), old[1]), put(last_half(h), old[2]);
  put(next_half(g), old[3]), put(last_half(g), old[0]);
}

/// Divides the triangle of h among its edges and a new vertex. h stays an edge of it.
void DelaunayMesh::split(uint32_t h, DVec2 p) {
  const uint32_t a = halves_[h].from, b = to(h), c = apex(h);
  const uint32_t vertex = uint32_t(points_.size()), n = uint32_t(halves_.size());
  const uint32_t second = next_half(h), third = last_half(h);
  points_.push_back(p);
  half_of_.push_back(third);
  halves_.resize(n + 6);
  put(n, halves_[second]), put(n + 3, halves_[third]);
  join(second, b, n + 2, vertex), join(n + 1, c, n + 5, vertex), join(n + 4, a, third, vertex);
  doubtful_.push_back(h);
}

void DelaunayMesh::settle() {
  while (!doubtful_.empty()) {
    const uint32_t h = doubtful_.back();
    doubtful_.pop_back();
    if (!halves_[h].fixed && is_encroached(h)) flip(h);
  }
}

uint32_t DelaunayMesh::add_point(DVec2 p) {
  uint32_t h = locate(p), on = kNoHalfEdge;
  for (int k = 0; k < 3; ++k, h = next_half(h)) {
    if (halves_[h].from != kInfinity && is_same(points_[halves_[h].from], p))
      return halves_[h].from;
    if (side(h, p) == 0) on = h;
  }
  recent_ = h;
  split(on == kNoHalfEdge ? h : on, p);
  if (on != kNoHalfEdge) {  // the triangle of that edge and the point is flat
    for (const uint32_t half : {next_half(on), last_half(on)}) set_fixed(half, halves_[on].fixed);
    set_fixed(on, false);
    flip(on);
  }
  settle();
  return uint32_t(points_.size() - 1);
}

uint32_t DelaunayMesh::half_between(uint32_t a, uint32_t b) const {
  uint32_t h = half_of_[a];
  while (to(h) != b) {
    h = halves_[last_half(h)].twin;
    LUXEL_CHECK(h != half_of_[a]);
  }
  return h;
}

/// From h's first vertex to b: along h, or between its triangle's edges.
bool DelaunayMesh::leads_to(uint32_t h, uint32_t b) const {
  const uint32_t a = halves_[h].from, u = to(h), w = apex(h);
  if (u == kInfinity) return false;
  const int side = turn(a, b, u);
  if (side == 0) return is_ahead(points_[a], points_[b], points_[u]);
  return side < 0 && w != kInfinity && turn(a, b, w) > 0;
}

DelaunayMesh::Way DelaunayMesh::way_to(uint32_t a, uint32_t b) const {
  const auto is_beside = [&](uint32_t v) {
    return is_between(points_[a], points_[b], points_[v], slack_);
  };
  uint32_t h = half_of_[a];
  while (!leads_to(h, b)) h = halves_[last_half(h)].twin;
  if (turn(a, b, to(h)) == 0) return {.left = {a, to(h)}};
  if (is_beside(to(h))) return {.beside = to(h)};
  if (is_beside(apex(h))) return {.beside = apex(h)};
  std::vector<uint32_t> left{a, apex(h)};
  for (h = next_half(h); !halves_[h].fixed;) {  // crosses the way from right to left
    const uint32_t twin = halves_[h].twin, v = apex(twin);
    const int side = turn(a, b, v);
    if (side >= 0) left.push_back(v);
    if (side == 0) return {.left = left};
    if (is_beside(v)) return {.beside = v};
    h = side > 0 ? next_half(twin) : last_half(twin);
  }
  return {.across = h};
}

/// Flips edges at v until u and w, before and after it on the left of the way, have an edge. v is
/// convex: the corners between u and w as v sees them lie right of the way and so not in the
/// triangle uvw. One of them is convex, too, and its edge to v can be flipped.
void DelaunayMesh::cut_ear(uint32_t u, uint32_t v, uint32_t w) {
  for (uint32_t h = half_between(v, u); apex(h) != w;) {
    const uint32_t edge = last_half(h), twin = halves_[edge].twin;
    if (turn(to(h), apex(h), apex(twin)) > 0) {
      flip(edge);
      h = half_between(v, u);
    } else {
      h = twin;
    }
  }
}

/// Makes an edge from the first to the last. A chain on one side of the line between its ends has a
/// convex corner as long as it has any: none is left behind.
void DelaunayMesh::clear(std::span<const uint32_t> left) {
  std::vector<uint32_t> chain;
  for (const uint32_t v : left) {
    while (chain.size() > 1 && turn(chain[chain.size() - 2], chain.back(), v) < 0) {
      cut_ear(chain[chain.size() - 2], chain.back(), v);
      chain.pop_back();
    }
    chain.push_back(v);
  }
}

/// Rounded crossings bend constraints, and bundles of lines that rounding hardly tells apart would
/// cross again and again. So constraints are led through vertices that they pass within rounding.
/// A proof that few cuts are left then is missing: pieces that cross after the last one are left
/// out.
void DelaunayMesh::add_constraint(uint32_t from, uint32_t to_vertex) {
  std::vector<std::array<uint32_t, 2>> pieces{{from, to_vertex}};
  const auto lead = [&](uint32_t a, uint32_t v, uint32_t b) {
    pieces.push_back({v, b}), pieces.push_back({a, v});
  };
  while (!pieces.empty()) {
    const auto [a, b] = pieces.back();
    pieces.pop_back();
    if (a == b) continue;
    const Way way = way_to(a, b);
    if (way.beside != kInfinity) {
      lead(a, way.beside, b);
    } else if (way.across == kNoHalfEdge) {
      clear(way.left);
      set_fixed(half_between(a, way.left.back()), true);
      settle();
      pieces.push_back({way.left.back(), b});
    } else if (cuts_left_ > 0) {
      --cuts_left_;
      const uint32_t u = halves_[way.across].from, w = to(way.across);
      const uint32_t v = cut(way.across, a, b);
      lead(a, v, b), lead(u, v, w);
    }
  }
}

/// Frees the constraint at h from u to w, and returns the vertex at which a way across it cuts it.
uint32_t DelaunayMesh::cut(uint32_t h, uint32_t a, uint32_t b) {
  const DVec2 u = points_[halves_[h].from], w = points_[to(h)];
  recent_ = h;
  set_fixed(h, false);
  for (const uint32_t end : {a, b})
    if (is_between(u, w, points_[end], slack_)) {
      settle();
      return end;
    }
  return add_point(crossing_of(points_[a], points_[b], u, w));
}

Triangulation DelaunayMesh::triangles() const {
  Triangulation out{{points_.begin() + 1, points_.end()}, {}};
  for (uint32_t h = 0; h < halves_.size(); h += 3) {
    const std::array corners{halves_[h].from, halves_[h + 1].from, halves_[h + 2].from};
    if (std::count(corners.begin(), corners.end(), kInfinity) == 0)
      out.triangles.push_back({corners[0] - 1, corners[1] - 1, corners[2] - 1});
  }
  return out;
}

}  // namespace

Triangulation constrained_delaunay(std::span<const DVec2> points,
                                   std::span<const std::array<uint32_t, 2>> constraints) {
  // The first triangle that is not flat.
  size_t b = 1;
  while (b < points.size() && is_same(points[0], points[b])) ++b;
  size_t c = b + 1;
  while (c < points.size() && orientation(points[0], points[b], points[c]) == 0) ++c;
  if (c >= points.size()) return {};
  if (orientation(points[0], points[b], points[c]) < 0) std::swap(b, c);
  // Straight lines cross once at most, so that half as many cuts would do.
  double largest = 0;
  for (const DVec2 p : points) largest = std::max({largest, std::abs(p.x), std::abs(p.y)});
  DelaunayMesh mesh(points[0], points[b], points[c], 2 * (DBL_EPSILON * largest + DBL_TRUE_MIN),
                    constraints.size() * constraints.size());
  std::vector<uint32_t> vertex;
  for (const DVec2 p : points) vertex.push_back(mesh.add_point(p));
  for (const auto& [from, to] : constraints) mesh.add_constraint(vertex[from], vertex[to]);
  return mesh.triangles();
}

}  // namespace luxel::hierarchical
