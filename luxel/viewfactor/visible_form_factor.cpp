#include "luxel/viewfactor/visible_form_factor.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <queue>

#include "luxel/viewfactor/shaft.h"

namespace luxel::viewfactor {
namespace {

using Triangle = std::array<DVec3, 3>;

struct Cell {
  Triangle corners;
  std::vector<uint32_t> blockers;  ///< that reach into its shaft; none: `value` is exact
  double value = 0, error = 0;
  double unseen = 0;      ///< what blockers that no sample has seen may hide
  bool shadowed = false;  ///< a sample has seen one; else `value` is the whole
};
struct SmallerError {
  bool operator()(const Cell& a, const Cell& b) const { return a.error < b.error; }
};

/// Radon's rule of degree 5: barycentric coordinates and weights of 7 points. [Radon48]
struct RuleNode {
  double u, v, weight;
};
constexpr double kOuter = 0.797426985353087, kOuterRest = 0.101286507323456;
constexpr double kInner = 0.059715871789770, kInnerRest = 0.470142064105115;
constexpr double kOuterWeight = 0.125939180544827, kInnerWeight = 0.132394152788506;
constexpr std::array<RuleNode, 7> kRule{{{1.0 / 3, 1.0 / 3, 0.225},
                                         {kOuter, kOuterRest, kOuterWeight},
                                         {kOuterRest, kOuter, kOuterWeight},
                                         {kOuterRest, kOuterRest, kOuterWeight},
                                         {kInner, kInnerRest, kInnerWeight},
                                         {kInnerRest, kInner, kInnerWeight},
                                         {kInnerRest, kInnerRest, kInnerWeight}}};

/// One pair of polygons at work.
struct PairIntegral {
  Polygon b;
  std::span<const Blocker> blockers;
  DVec3 normal;  ///< of a
  double tolerance = 0, slack = 0;
  std::vector<uint8_t> casts_shadow;
  VisibilityScratch scratch;
};

/// True when every line between the polygons meets the blocker. Lines between corners suffice: the
/// others meet its plane between them.
bool hides_all(const Blocker& blocker, PolygonView a, PolygonView b, double slack) {
  const size_t count = blocker.corners.size();
  for (const DVec3& p : a)
    for (const DVec3& q : b) {
      const double hp = blocker.plane.height(p), hq = blocker.plane.height(q);
      if (!((hp > slack && hq < -slack) || (hp < -slack && hq > slack))) return false;
      const DVec3 at = p + (q - p) * (hp / (hp - hq));
      for (size_t i = 0; i < count; ++i) {
        const DVec3 from = blocker.corners[i], to = blocker.corners[(i + 1) % count];
        if (dot(cross(to - from, at - from), blocker.plane.normal) < 0) return false;
      }
    }
  return true;
}

/// True when the blocker's plane has both polygons on one side: it stands beside them.
bool stands_beside(const Blocker& blocker, PolygonView a, PolygonView b, double slack) {
  bool above = false, below = false;
  for (const PolygonView polygon : {a, b})
    for (const DVec3& p : polygon) {
      const double height = blocker.plane.height(p);
      above |= height > slack, below |= height < -slack;
    }
  return !(above && below);
}

/// Keeps the blockers that reach into the shaft. False when one of them hides everything.
bool keep_reaching(const PairIntegral& pair, PolygonView a, const Shaft& shaft,
                   std::span<const uint32_t> candidates, std::vector<uint32_t>& kept) {
  for (const uint32_t index : candidates) {
    const Blocker& blocker = pair.blockers[index];
    if (stands_beside(blocker, a, pair.b, pair.slack)) continue;
    if (is_outside(shaft, blocker.corners)) continue;
    if (hides_all(blocker, a, pair.b, pair.slack)) return false;
    kept.push_back(index);
  }
  return true;
}

/// A cell's value and, until splitting tells more, all of it as its error where there are shadows.
Cell evaluate(PairIntegral& pair, const Triangle& corners, std::span<const uint32_t> candidates) {
  Cell cell{corners, {}, 0, 0, 0, false};
  const Shaft shaft = shaft_between(corners, pair.b, pair.slack);
  if (!keep_reaching(pair, corners, shaft, candidates, cell.blockers)) {
    cell.blockers.clear();
    return cell;
  }
  if (cell.blockers.empty()) {
    cell.value = polygon_exchange_area(corners, pair.b, 1e-3 * pair.tolerance, pair.slack).value;
    return cell;
  }
  for (const uint32_t b : cell.blockers) pair.casts_shadow[b] = 0;
  const double area = area_m2(corners);
  double whole = 0;
  for (const RuleNode& node : kRule) {
    const DVec3 x = corners[0] * (1 - node.u - node.v) + corners[1] * node.u + corners[2] * node.v;
    const SeenFactor seen =
        visible_point_factor(x, pair.normal, pair.b, {pair.blockers, cell.blockers}, pair.slack,
                             pair.casts_shadow, pair.scratch);
    cell.value += node.weight * area * seen.visible;
    whole += node.weight * area * seen.whole;
  }
  bool shadowed = false;
  for (const uint32_t b : cell.blockers) {
    shadowed |= pair.casts_shadow[b] != 0;
    if (pair.casts_shadow[b]) continue;
    const Intrusion into = intrusion(shaft, corners, pair.b, pair.blockers[b].corners);
    cell.unseen += std::min(whole * into.share, into.area_m2);
  }
  if (!shadowed)
    cell.value = polygon_exchange_area(corners, pair.b, 1e-3 * pair.tolerance, pair.slack).value;
  cell.shadowed = shadowed;
  cell.unseen = std::min(cell.unseen, cell.value);  // no more than is left can be hidden
  // Where all samples lie in the dark, light can only be near the corners.
  const double guess = cell.value > 0 ? whole : 0.02 * whole;
  cell.error = shadowed ? guess : cell.unseen;
  return cell;
}

std::array<Cell, 4> split(PairIntegral& pair, const Cell& cell) {
  const auto& [p, q, r] = cell.corners;
  const DVec3 pq = (p + q) * 0.5, qr = (q + r) * 0.5, rp = (r + p) * 0.5;
  return {evaluate(pair, {p, pq, rp}, cell.blockers), evaluate(pair, {pq, q, qr}, cell.blockers),
          evaluate(pair, {rp, qr, r}, cell.blockers), evaluate(pair, {pq, qr, rp}, cell.blockers)};
}

/// What splitting changed is the parent's error, and at kinks, where the rule is at its worst, the
/// children together have a fourth of it left. Symmetry may hide a change: the guess never falls to
/// less than a tenth in one step.
void share_error(const Cell& parent, std::span<Cell> children) {
  double sum = 0, sampled = 0;
  for (const Cell& child : children) {
    sum += child.value;
    sampled += child.shadowed ? 1 : 0;
  }
  const double error = std::max(0.25 * std::abs(sum - parent.value), 0.1 * parent.error);
  for (Cell& child : children)
    if (child.shadowed) child.error = std::max(error / sampled, child.unseen);
}

/// Along a blocker that stands on `a` the visible part of `b` jumps: `a` is cut there first.
std::vector<Polygon> cut_at_standing_blockers(const Polygon& a, const PairIntegral& pair,
                                              std::span<const uint32_t> blockers) {
  constexpr size_t kMaxPieces = 64;
  const Plane ground = plane_of(a);
  std::vector<Polygon> pieces{a};
  for (const uint32_t index : blockers) {
    const Blocker& blocker = pair.blockers[index];
    double lowest = INFINITY;
    for (const DVec3& p : blocker.corners) lowest = std::min(lowest, ground.height(p));
    if (lowest > pair.slack || pieces.size() >= kMaxPieces) continue;
    std::vector<Polygon> cut;
    for (const Polygon& piece : pieces)
      for (const Plane& side : {blocker.plane, Plane{-blocker.plane.normal, -blocker.plane.offset}})
        if (Polygon part = clip_above(piece, side, pair.slack); !part.empty())
          cut.push_back(std::move(part));
    pieces = std::move(cut);
  }
  return pieces;
}

/// Errors of many cells at once. Those of sampled cells depend on where the edges of shadows happen
/// to cross them: their signs are random, and they add up like the steps of a random walk, of which
/// four standard deviations are taken. What may not have been seen has one sign.
struct ErrorSum {
  double unseen = 0, sampled = 0, squares = 0;

  void add(const Cell& cell, double sign) {
    if (!cell.shadowed) {
      unseen += sign * cell.error;
      return;
    }
    sampled += sign * cell.error;
    squares += sign * cell.error * cell.error;
  }
  double total() const {
    return std::max(0.0, unseen) +
           std::max(0.0, std::min(sampled, 4 * std::sqrt(std::max(0.0, squares))));
  }
};

/// Splits the worst cell until the sum of errors is small against the sum of values.
VisibleExchange refine(PairIntegral& pair, std::span<const Polygon> pieces,
                       std::span<const uint32_t> blockers, double unoccluded,
                       const VisibleParams& params) {
  std::priority_queue<Cell, std::vector<Cell>, SmallerError> open;
  VisibleExchange sum;
  ErrorSum errors;
  const auto take = [&](Cell cell) {
    ++sum.cells;
    sum.value += cell.value;
    errors.add(cell, 1);
    if (!cell.blockers.empty()) open.push(std::move(cell));
  };
  for (const Polygon& piece : pieces)
    for (size_t i = 2; i < piece.size(); ++i)
      take(evaluate(pair, {piece[0], piece[i - 1], piece[i]}, blockers));
  const double least = pair.tolerance * std::max(params.negligible_m2, 1e-3 * unoccluded);
  const auto is_rough = [&] {
    return !open.empty() && errors.total() > std::max(least, pair.tolerance * sum.value);
  };
  while (is_rough() && sum.cells < params.max_cells &&
         !(params.progress && params.progress->cancelled())) {
    const Cell parent = open.top();
    open.pop();
    std::array<Cell, 4> children = split(pair, parent);
    share_error(parent, children);
    sum.value -= parent.value;
    errors.add(parent, -1);
    for (Cell& child : children) take(std::move(child));
  }
  sum.gave_up = is_rough();
  sum.value = std::max(0.0, sum.value);  // differences of what was split leave 1e-18
  sum.error = errors.total();
  return sum;
}

}  // namespace

VisibleExchange visible_exchange_area(PolygonView a, PolygonView b,
                                      std::span<const Blocker> blockers,
                                      const VisibleParams& params) {
  const Plane plane_a = plane_of(a), plane_b = plane_of(b);
  if (plane_a.normal == DVec3{} || plane_b.normal == DVec3{}) return {};
  PairIntegral pair{{}, blockers, plane_a.normal, params.tolerance, params.slack_m, {}, {}};
  pair.slack = std::max(params.slack_m, 1e-13 * std::max(magnitude(a), magnitude(b)));
  pair.b = clip_above(b, plane_a, pair.slack);
  const Polygon front_a = clip_above(a, plane_b, pair.slack);
  if (front_a.empty() || pair.b.empty()) return {};
  pair.casts_shadow.assign(blockers.size(), 0);
  std::vector<uint32_t> candidates, reaching;
  for (uint32_t i = 0; i < blockers.size(); ++i)
    if (blockers[i].area_m2 > 0) candidates.push_back(i);
  const Shaft shaft = shaft_between(front_a, pair.b, pair.slack);
  if (!keep_reaching(pair, front_a, shaft, candidates, reaching)) return {};
  const ExchangeArea unoccluded = polygon_exchange_area(
      front_a, pair.b, reaching.empty() ? 1e-12 : 1e-3 * params.tolerance, pair.slack);
  if (reaching.empty()) return {unoccluded.value, unoccluded.rounding, 0, false};
  // Large blockers first: what they hide whole need not be cut.
  std::stable_sort(reaching.begin(), reaching.end(), [&](uint32_t i, uint32_t j) {
    return blockers[i].area_m2 > blockers[j].area_m2;
  });
  const std::vector<Polygon> pieces = cut_at_standing_blockers(front_a, pair, reaching);
  return refine(pair, pieces, reaching, unoccluded.value, params);
}

FormFactor form_factor(PolygonView a, PolygonView b, std::span<const Polygon> blockers,
                       double tolerance) {
  std::vector<Blocker> opaque;
  for (const Polygon& polygon : blockers) opaque.push_back(make_blocker(polygon));
  const double area = area_m2(a);
  if (!(area > 0)) return {};
  const VisibleExchange exchange = visible_exchange_area(a, b, opaque, {.tolerance = tolerance});
  return {std::max(0.0, exchange.value) / area, exchange.error / area};
}

}  // namespace luxel::viewfactor
