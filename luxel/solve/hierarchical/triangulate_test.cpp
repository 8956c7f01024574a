#include "luxel/solve/hierarchical/triangulate.h"

#include <gtest/gtest.h>

#include <cfloat>
#include <map>
#include <numbers>
#include <set>

#include "luxel/base/exact_predicates.h"
#include "luxel/base/random.h"

namespace luxel::hierarchical {
namespace {

using Pair = std::array<uint32_t, 2>;
__extension__ using Int = __int128;

/// A problem whose coordinates are whole multiples of `unit`, also those of crossings, at most 2^54
/// times as large.
struct Problem {
  std::vector<DVec2> points;
  std::vector<Pair> constraints;
  double unit = 1;
  double slack = 0;  ///< this near to a constraint rounding leaves its pieces

  uint32_t add(DVec2 p) {
    points.push_back(p);
    return uint32_t(points.size() - 1);
  }
  void add_line(DVec2 a, DVec2 b) {
    const uint32_t from = add(a);
    constraints.push_back({from, add(b)});
  }
  /// Convex, counter-clockwise.
  void add_outline(std::span<const DVec2> corners) {
    const uint32_t first = uint32_t(points.size()), n = uint32_t(corners.size());
    for (uint32_t k = 0; k < n; ++k)
      add(corners[k]), constraints.push_back({first + k, first + (k + 1) % n});
  }
  void add_square(double x0, double y0, double x1, double y1) {
    add_outline(std::array<DVec2, 4>{{{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}});
  }
  Triangulation solve() const { return constrained_delaunay(points, constraints); }
};

Int area2(const Problem& problem, DVec2 a, DVec2 b, DVec2 c) {
  const auto n = [&](double x) { return Int(x / problem.unit); };
  return (n(b.x) - n(a.x)) * (n(c.y) - n(a.y)) - (n(b.y) - n(a.y)) * (n(c.x) - n(a.x));
}

/// Depth of d inside the circle through a, b, c, as the determinant, rounded to 113 bits.
__float128 depth_in_circle(DVec2 a, DVec2 b, DVec2 c, DVec2 d) {
  using Wide = __float128;
  const Wide ax = Wide(a.x) - d.x, ay = Wide(a.y) - d.y, bx = Wide(b.x) - d.x, by = Wide(b.y) - d.y,
             cx = Wide(c.x) - d.x, cy = Wide(c.y) - d.y;
  return (ax * ax + ay * ay) * (bx * cy - by * cx) + (bx * bx + by * by) * (cx * ay - cy * ax) +
         (cx * cx + cy * cy) * (ax * by - ay * bx);
}

bool is_on(const Problem& problem, const Pair& constraint, DVec2 p) {
  const DVec2 a = problem.points[constraint[0]], d = problem.points[constraint[1]] - a;
  const double along = dot(p - a, d), slack = problem.slack * length(d);
  return std::abs(cross(d, p - a)) <= slack && along >= -slack && along <= dot(d, d) + slack;
}

/// The corner of the triangle on the left, per directed edge.
using Apexes = std::map<Pair, uint32_t>;
Apexes apexes_of(const Triangulation& t) {
  Apexes out;
  for (const auto& c : t.triangles)
    for (size_t k = 0; k < 3; ++k)
      EXPECT_TRUE(out.emplace(Pair{c[k], c[(k + 1) % 3]}, c[(k + 2) % 3]).second) << "overlap";
  return out;
}

/// Edges lead along the constraint from one end to the other.
bool is_covered(const Problem& problem, const Pair& constraint, const Triangulation& t,
                const Apexes& apexes) {
  const DVec2 a = problem.points[constraint[0]], b = problem.points[constraint[1]];
  std::vector<std::pair<double, uint32_t>> on;  // by place
  for (uint32_t k = 0; k < t.points.size(); ++k)
    if (is_on(problem, constraint, t.points[k])) on.emplace_back(dot(t.points[k] - a, b - a), k);
  std::sort(on.begin(), on.end());
  std::set<uint32_t> reached;
  for (const auto& [place, v] : on) {
    const DVec2 p = t.points[v];
    bool is_reached = p.x == a.x && p.y == a.y;
    for (const uint32_t u : reached)
      is_reached |= apexes.contains({u, v}) || apexes.contains({v, u});
    if (is_reached) reached.insert(v);
    if (is_reached && p.x == b.x && p.y == b.y) return true;
  }
  return (a.x == b.x && a.y == b.y);
}

/// All that a constrained Delaunay triangulation promises, by whole numbers.
void expect_right(const Problem& problem, const Triangulation& t, Int hull_area2) {
  Int sum = 0;
  for (const auto& c : t.triangles) {
    const Int twice = area2(problem, t.points[c[0]], t.points[c[1]], t.points[c[2]]);
    EXPECT_TRUE(twice > 0) << "a triangle is clockwise or flat";
    sum += twice;
  }
  EXPECT_TRUE(sum == hull_area2) << double(sum) << " " << double(hull_area2);
  const Apexes apexes = apexes_of(t);
  for (size_t k = 0; k < problem.constraints.size(); ++k)
    EXPECT_TRUE(is_covered(problem, problem.constraints[k], t, apexes)) << "constraint " << k;
  const double size = problem.unit * std::ldexp(1.0, 54);
  for (const auto& [edge, apex] : apexes) {
    const auto other = apexes.find({edge[1], edge[0]});
    const DVec2 a = t.points[edge[0]], b = t.points[edge[1]];
    if (other == apexes.end() || depth_in_circle(a, b, t.points[apex], t.points[other->second]) <=
                                     (problem.slack > 0 ? 1e-30 * std::pow(size, 4) : 0))
      continue;
    EXPECT_TRUE(
        std::any_of(problem.constraints.begin(), problem.constraints.end(),
                    [&](const Pair& c) { return is_on(problem, c, a) && is_on(problem, c, b); }))
        << "an edge is to be flipped";
  }
}

TEST(Triangulate, LinesBecomeEdges) {
  const std::array<DVec2, 5> outline{DVec2{0, 0}, {2, 0}, {2, 1}, {1, 1}, {0, 1}};
  const std::array<Segment2, 2> lines{Segment2{{0.5, 0}, {1, 1}}, {{0, 0.5}, {2, 0.25}}};
  const Triangulation t = triangulate(outline, lines, 1e-6);
  double area = 0;
  for (const auto& c : t.triangles) {
    const double twice = cross(t.points[c[1]] - t.points[c[0]], t.points[c[2]] - t.points[c[0]]);
    EXPECT_GT(twice, 0);
    area += twice / 2;
    // No triangle lies on both sides of a line.
    for (const Segment2& line : lines) {
      bool left = false, right = false;
      for (const uint32_t k : c) {
        const double side = cross(line.b - line.a, t.points[k] - line.a);
        left |= side > 1e-9, right |= side < -1e-9;
      }
      EXPECT_FALSE(left && right);
    }
  }
  EXPECT_NEAR(area, 2, 1e-12);
}

TEST(Triangulate, NearPointsBecomeOneAndFlatTrianglesNone) {
  // Outside of (1, 1e-12) the hull has a flat triangle, and a line ends 1e-12 beside a corner.
  const std::array<DVec2, 5> outline{DVec2{0, 0}, {1, 1e-12}, {2, 0}, {2, 1}, {0, 1}};
  const std::array<Segment2, 2> lines{Segment2{{1e-12, 1e-12}, {2, 1}}, {{1, 0}, {1, 1}}};
  const Triangulation t = triangulate(outline, lines, 1e-9);
  EXPECT_EQ(t.points.size(), 7u);  // five, (1, 1), and the crossing
  EXPECT_EQ(t.triangles.size(), 6u);
}

TEST(ConstrainedDelaunay, PointsOnOneLineHaveNoTriangles) {
  EXPECT_TRUE(constrained_delaunay({}, {}).triangles.empty());
  EXPECT_TRUE(triangulate({}, {}, 0).triangles.empty());
  const std::vector<Pair> constraints{{0, 1}, {0, 0}, {1, 0}};
  for (const std::vector<DVec2>& points : {std::vector<DVec2>{{1, 2}, {1, 2}},
                                           {{1, 2}, {1, 2}, {1, 2}, {3, 4}},
                                           {{0, 0}, {3, 3}, {1, 1}, {2, 2}, {1, 1}},
                                           {{1, 5}, {1, 2}, {1, DBL_MAX}}})
    EXPECT_TRUE(constrained_delaunay(points, constraints).triangles.empty());
}

TEST(ConstrainedDelaunay, PointsAreCornersOfTheirDelaunayTriangles) {
  // Many on one circle or one line, and the same twice.
  for (uint64_t seed = 0; seed < 20; ++seed) {
    Problem problem;
    RandomStream random{seed};
    problem.add_square(0, 0, 12, 12);
    for (int k = 0; k < 80; ++k)
      problem.add({std::floor(13 * random.next()), std::floor(13 * random.next())});
    std::set<std::pair<double, double>> places;
    for (const DVec2 p : problem.points) places.emplace(p.x, p.y);
    const Triangulation t = problem.solve();
    EXPECT_EQ(t.points.size(), places.size());
    expect_right(problem, t, 2 * 144);
  }
}

TEST(ConstrainedDelaunay, GridsAreCutAtTheirCrossings) {
  Problem problem;
  problem.add_square(0, 0, 24, 24);
  for (double x = 1; x < 24; x += 2) {
    problem.add_line({x, 0}, {x, 24});
    problem.add_line({24, x}, {0, x});
    problem.add_line({0, x}, {24 - x, 24});  // through crossings, and half between others
  }
  const Triangulation t = problem.solve();
  problem.unit = 0.5;
  expect_right(problem, t, 8 * 24 * 24);
  for (double x = 1; x < 24; x += 2)
    for (double y = 1; y < 24; y += 2)
      EXPECT_EQ(std::count_if(t.points.begin(), t.points.end(),
                              [&](DVec2 p) { return p.x == x && p.y == y; }),
                1);
}

TEST(ConstrainedDelaunay, OverlappingConstraintsShareTheirEdges) {
  Problem problem;
  problem.add_square(0, 0, 12, 12);
  problem.add_line({1, 1}, {9, 9});
  problem.add_line({11, 11}, {4, 4});
  problem.add_line({6, 6}, {7, 7});
  problem.add_line({0, 12}, {12, 0});
  problem.add_line({0, 3}, {0, 15 - 6});  // on the outline
  problem.add({5, 5});
  const Triangulation t = problem.solve();
  expect_right(problem, t, 2 * 144);
  EXPECT_EQ(t.points.size(), 13u);  // two ends are corners, and (6, 6) is the crossing
}

TEST(ConstrainedDelaunay, LinesThroughOnePointMeetThere) {
  Problem problem;
  problem.unit = DBL_EPSILON;
  problem.slack = 1e-15;
  problem.add_square(1, 1, 1.75, 1.75);
  for (int k = 0; k < 16; ++k) {
    const DVec2 d{std::cos(k * 0.19), std::sin(k * 0.19)}, middle{1.4, 1.3};
    problem.add_line(middle - d * 0.1, middle + d * 0.2);
  }
  const Triangulation t = problem.solve();
  expect_right(problem, t, Int(9) << 101);
  EXPECT_EQ(t.points.size(), problem.points.size() + 1);
}

TEST(ConstrainedDelaunay, NearbyLinesAndPointsAreToldApart) {
  Problem problem;
  problem.unit = DBL_EPSILON;
  problem.slack = 3e-15;
  problem.add_square(1, 1, 1.5, 1.5);
  for (int k = 0; k < 12; ++k) {  // lines 1e-12 apart, and lines that turn by 1e-13 about a point
    problem.add_line({1.1 + k * 1e-12, 1.1}, {1.4, 1.2 + k * 1e-12});
    problem.add_line({1.1, 1.2 + k * 1e-13}, {1.3, 1.3 - k * 1e-13});
    problem.add_line({1.1, 1.3 + k * DBL_EPSILON}, {1.4, 1.45 - k * DBL_EPSILON});
    problem.add({1.25 + k * 1e-12, 1.15 + k * 1e-12});
  }
  expect_right(problem, problem.solve(), Int(1) << 103);
}

/// A convex polygon in [1, 2)^2 and segments between points inside it.
Problem random_problem(uint64_t seed, int segments) {
  Problem problem;
  problem.unit = DBL_EPSILON;
  problem.slack = 2e-15;
  RandomStream random{seed};
  std::vector<DVec2> outline;
  for (int k = 0; k < 9; ++k) {
    const double angle = (k + 0.8 * random.next()) * 2 * std::numbers::pi / 9;
    outline.push_back({1.5 + 0.45 * std::cos(angle), 1.5 + 0.45 * std::sin(angle)});
  }
  problem.add_outline(outline);
  const auto inside = [&] { return DVec2{1.3 + 0.4 * random.next(), 1.3 + 0.4 * random.next()}; };
  for (int k = 0; k < segments; ++k) {
    const DVec2 a = inside();
    problem.add_line(a, inside());
  }
  return problem;
}

TEST(ConstrainedDelaunay, HundredsOfSegmentsCross) {
  for (const auto& [seed, segments] : {std::pair{1, 4}, {2, 12}, {3, 40}, {4, 120}}) {
    const Problem problem = random_problem(uint64_t(seed), segments);
    Int area = 0;
    for (size_t k = 2; k < 9; ++k)
      area += area2(problem, problem.points[0], problem.points[k - 1], problem.points[k]);
    const Triangulation t = problem.solve();
    expect_right(problem, t, area);
    const Triangulation again = problem.solve();
    EXPECT_EQ(t.triangles, again.triangles);
  }
}

TEST(ConstrainedDelaunay, IsTheSameFarFromTheOrigin) {
  Problem problem;
  problem.add_square(0, 0, 64, 64);
  RandomStream random{7};
  for (int k = 0; k < 20; ++k) {  // cross at whole points
    const double x = 1 + std::floor(62 * random.next()), y = 1 + std::floor(62 * random.next());
    problem.add_line({x, y}, {x, 63});
    problem.add_line({y, x}, {63, x});
  }
  Problem far = problem;
  for (DVec2& p : far.points) p = p + DVec2{0x1p48, -0x1p47};
  const Triangulation t = problem.solve(), moved = far.solve();
  EXPECT_EQ(t.triangles, moved.triangles);
  expect_right(problem, t, 2 * 64 * 64);
  expect_right(far, moved, 2 * 64 * 64);
}

TEST(ConstrainedDelaunay, EndsWhateverTheNumbers) {
  // Bundles of lines that a few ulps tell apart, and any numbers that a double can be.
  RandomStream random{11};
  for (int trial = 0; trial < 24; ++trial) {
    Problem problem;
    const double size = std::ldexp(1.0, int(random.next() * 2000) - 1060);
    const double grain = std::ldexp(1.0, -int(random.next() * 53));
    const auto place = [&] {
      const double wild = trial % 3 == 2 ? std::ldexp(1.0, -int(random.next() * 70)) : 1;
      return size * wild * std::round((2 * random.next() - 1) / grain) * grain;
    };
    for (int k = 0; k < 25; ++k) {
      const double y = place();
      const double bend = std::floor(random.next() * 4) * DBL_EPSILON * size;
      if (trial % 3 == 0)
        problem.add_line({-size, -size / 3 + bend}, {size, size / 7 - bend + k % 2 * bend});
      else
        problem.add_line({place(), y}, {place(), place()});
    }
    const Triangulation t = problem.solve();
    for (const auto& c : t.triangles)
      EXPECT_EQ(orientation(t.points[c[0]], t.points[c[1]], t.points[c[2]]), 1);
    for (const DVec2 p : t.points) EXPECT_TRUE(std::isfinite(p.x) && std::isfinite(p.y));
    EXPECT_LE(t.points.size(), problem.points.size() + 25 * 24 / 2) << "lines cross once";
  }
}

}  // namespace
}  // namespace luxel::hierarchical
