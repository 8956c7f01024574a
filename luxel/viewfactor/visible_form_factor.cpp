#include "luxel/viewfactor/visible_form_factor.h"

#include <algorithm>
#include <array>
#include <queue>

#include "luxel/viewfactor/shadow_lines.h"
#include "luxel/viewfactor/shaft.h"

namespace luxel::viewfactor {
namespace {

struct Cell {
  Triangle corners;
  std::vector<uint32_t> blockers = {};  ///< that reach into its shaft; none: `value` is exact
  double value = 0;
  double rough = 0;   ///< the rule's error
  double change = 0;  ///< its share of what the last split changed, as it may go on, with its sign
  double unseen = 0;  ///< what blockers that no sample has seen may hide
  bool shadowed = false;    ///< a sample has seen one; else `value` is the whole
  bool is_crossed = false;  ///< by a shadow line that the rule may step over

  double error() const { return rough + unseen; }
};
struct SmallerError {
  bool operator()(const Cell& a, const Cell& b) const { return a.error() < b.error(); }
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

/// The share of a change that is left in the children.
constexpr double kLeftAtKinks = 0.25, kLeftAtJumps = 1;
/// The share of the parent's error that stays in the children at least. Where shadows end sharply,
/// samples may not show it for several steps.
constexpr double kLeastAtKinks = 0.1, kLeastAtJumps = 0.3;

/// One pair of polygons at work.
struct PairIntegral {
  Polygon b;
  std::span<const Blocker> blockers;
  DVec3 normal;  ///< of a
  double tolerance = 0, slack = 0;
  ShadowLines lines;
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

double longest_edge(const Triangle& t) {
  return std::sqrt(std::max({dot(t[1] - t[0], t[1] - t[0]), dot(t[2] - t[1], t[2] - t[1]),
                             dot(t[0] - t[2], t[0] - t[2])}));
}

/// Calls visit(line, chord) for the shadow lines that cross the cell and that its rule may
/// step over.
template <class Visit>
void for_each_sharp_line(const PairIntegral& pair, const Cell& cell, const Visit& visit) {
  const double size = longest_edge(cell.corners);
  for (const uint32_t b : cell.blockers)
    for (const ShadowLine& line : pair.lines.of(b)) {
      if (!is_sharp(line, size)) continue;
      const Chord chord = chord_of(line, cell.corners, pair.slack);
      if (!chord.is_empty) visit(line, chord);
    }
}

SeenFactor seen_from(PairIntegral& pair, const Cell& cell, DVec3 x) {
  return visible_point_factor(x, pair.normal, pair.b, {pair.blockers, cell.blockers}, pair.slack,
                              pair.casts_shadow, pair.scratch);
}

/// Sets the value by the rule, and casts_shadow. Returns what would arrive without blockers.
double sample(PairIntegral& pair, Cell& cell) {
  for (const uint32_t b : cell.blockers) pair.casts_shadow[b] = 0;
  const auto& [p, q, r] = cell.corners;
  const double area = area_m2(cell.corners);
  double whole = 0;
  for (const RuleNode& node : kRule) {
    const SeenFactor seen =
        seen_from(pair, cell, p * (1 - node.u - node.v) + q * node.u + r * node.v);
    cell.value += node.weight * area * seen.visible;
    whole += node.weight * area * seen.whole;
  }
  return whole;
}

/// A cell's value and, until splitting tells more, all of it as its error where there are shadows.
Cell evaluate(PairIntegral& pair, const Triangle& corners, std::span<const uint32_t> candidates) {
  Cell cell{.corners = corners};
  const Shaft shaft = shaft_between(corners, pair.b, pair.slack);
  if (!keep_reaching(pair, corners, shaft, candidates, cell.blockers)) {
    cell.blockers.clear();
    return cell;
  }
  const auto closed_form = [&] {
    return polygon_exchange_area(corners, pair.b, 1e-3 * pair.tolerance, pair.slack).value;
  };
  if (cell.blockers.empty()) {
    cell.value = closed_form();
    return cell;
  }
  const double whole = sample(pair, cell);
  for_each_sharp_line(pair, cell, [&](const ShadowLine&, const Chord&) { cell.is_crossed = true; });
  for (const uint32_t b : cell.blockers) {
    cell.shadowed |= pair.casts_shadow[b] != 0;
    if (pair.casts_shadow[b]) continue;
    const Intrusion into = intrusion(shaft, corners, pair.b, pair.blockers[b].corners);
    cell.unseen += std::min(whole * into.share, into.area_m2);
  }
  if (!cell.shadowed) cell.value = closed_form();
  // Where all samples lie in the dark, light can only be near the corners, or in the strip between
  // an edge and the samples next to it, an eighth of the cell, where a shadow ends sharply.
  if (cell.shadowed) cell.rough = (cell.value > 0 ? 1 : cell.is_crossed ? 0.12 : 0.02) * whole;
  cell.unseen = std::min(cell.unseen, cell.value);  // no more than is left can be hidden
  return cell;
}

/// Distance from a point in the triangle to its border in a direction.
double room_towards(const Triangle& triangle, DVec3 from, DVec3 direction) {
  const DVec3 up = cross(triangle[1] - triangle[0], triangle[2] - triangle[0]);
  double room = INFINITY;
  for (size_t k = 0; k < 3; ++k) {
    const DVec3 inwards = cross(up, triangle[(k + 1) % 3] - triangle[k]);
    const double speed = -dot(inwards, direction);
    if (speed > 0) room = std::min(room, std::max(0.0, dot(inwards, from - triangle[k])) / speed);
  }
  return room;
}

struct Cut {
  ShadowLine line;
  DVec3 middle;
  double room = 0;   ///< to the nearer side of the cell
  double score = 0;  ///< its length times `room`
};

/// Share of b that comes into view or is lost across a line, within a twentieth of the cell. Thin
/// walls hide as much on both sides of their foot, and nothing a little farther off.
double jump_across(PairIntegral& pair, const Cell& cell, const Cut& cut) {
  const double step = std::min(0.5 * cut.room, 0.05 * longest_edge(cell.corners));
  std::array<double, 4> share{};
  constexpr std::array<double, 4> kPlaces{-1, -0.1, 0.1, 1};
  for (size_t k = 0; k < 4; ++k) {
    const SeenFactor seen =
        seen_from(pair, cell, cut.middle + cut.line.normal * (kPlaces[k] * step));
    if (seen.whole > 0) share[k] = seen.visible / seen.whole;
  }
  return *std::max_element(share.begin(), share.end()) -
         *std::min_element(share.begin(), share.end());
}

/// The shadow line across which the most changes within a short way. False where nothing does.
bool find_cut(PairIntegral& pair, const Cell& cell, Cut& best) {
  constexpr size_t kMostProbes = 12;
  constexpr double kLeastJump = 0.1, kLeastLength = 0.1;
  if (!cell.is_crossed) return false;
  std::vector<Cut> cuts;
  for_each_sharp_line(pair, cell, [&](const ShadowLine& line, const Chord& chord) {
    const double length_m = length(chord.to - chord.from);
    Cut cut{line, (chord.from + chord.to) * 0.5, 0, 0};
    cut.room = std::min(room_towards(cell.corners, cut.middle, line.normal),
                        room_towards(cell.corners, cut.middle, -line.normal));
    cut.score = length_m * cut.room;
    if (length_m > kLeastLength * chord.whole_m && cut.score > 0) cuts.push_back(cut);
  });
  const size_t probes = std::min(kMostProbes, cuts.size());
  std::partial_sort(cuts.begin(), cuts.begin() + ptrdiff_t(probes), cuts.end(),
                    [](const Cut& a, const Cut& b) { return a.score > b.score; });
  double most = 0;
  for (size_t k = 0; k < probes; ++k) {
    if (cuts[k].score <= most) break;
    const double jump = jump_across(pair, cell, cuts[k]);
    if (jump > kLeastJump && jump * cuts[k].score > most)
      most = jump * cuts[k].score, best = cuts[k];
  }
  return most > 0;
}

void add_parts(PairIntegral& pair, const Cell& cell, const Plane& side, std::vector<Cell>& parts) {
  const Polygon part = clip_above(cell.corners, side, 0);
  for (size_t i = 2; i < part.size(); ++i)
    parts.push_back(evaluate(pair, {part[0], part[i - 1], part[i]}, cell.blockers));
}

/// Along a line where what is seen changes abruptly, or else into four.
std::vector<Cell> split(PairIntegral& pair, const Cell& cell) {
  std::vector<Cell> parts;
  if (Cut cut; find_cut(pair, cell, cut)) {
    add_parts(pair, cell, {cut.line.normal, cut.line.offset}, parts);
    add_parts(pair, cell, {-cut.line.normal, -cut.line.offset}, parts);
    return parts;
  }
  const auto add = [&](const DVec3& a, const DVec3& b, const DVec3& c) {
    parts.push_back(evaluate(pair, {a, b, c}, cell.blockers));
  };
  const auto& [p, q, r] = cell.corners;
  const DVec3 pq = (p + q) * 0.5, qr = (q + r) * 0.5, rp = (r + p) * 0.5;
  add(p, pq, rp), add(pq, q, qr), add(rp, qr, r), add(pq, qr, rp);
  return parts;
}

/// The change by splitting is the parent's error. At kinks, where the rule is at its worst, the
/// children together have a fourth of it left; where a shadow still ends abruptly, all of it.
/// Symmetry may hide a change: the guess falls to no less than a certain share in one step.
void share_error(const Cell& parent, std::span<Cell> children) {
  double sum = 0, sampled = 0;
  for (const Cell& child : children) {
    sum += child.value;
    sampled += child.shadowed ? 1 : 0;
  }
  const double change = sum - parent.value;
  for (Cell& child : children) {
    if (!child.shadowed) continue;
    const double left = (child.is_crossed ? kLeftAtJumps : kLeftAtKinks) * change / sampled;
    child.change = left;
    const double least =
        (child.is_crossed ? kLeastAtJumps : kLeastAtKinks) * parent.error() / sampled;
    child.rough = std::max(std::abs(left), least);
  }
}

/// Errors of many cells at once. Those of sampled cells depend on how the edges of shadows cross
/// them. Where the signs are random, they add up like the steps of a random walk, of which four
/// standard deviations are taken. Along an edge of a shadow many cells are crossed in the same way:
/// the signs that splitting showed tell how much the errors have in common. What may not have been
/// seen has one sign.
struct ErrorSum {
  double unseen = 0, sampled = 0, common = 0, squares = 0;

  void add(const Cell& cell, double sign) {
    unseen += sign * cell.unseen;
    sampled += sign * cell.rough;
    common += sign * cell.change;
    squares += sign * cell.rough * cell.rough;
  }
  double total() const {
    const double walk = 4 * std::sqrt(std::max(0.0, squares));
    return std::max(0.0, unseen) + std::max(0.0, std::min(sampled, std::abs(common) + walk));
  }
};

/// Splits the worst cell until the sum of errors is small against the sum of values.
VisibleExchange refine(PairIntegral& pair, PolygonView a, std::span<const uint32_t> blockers,
                       double unoccluded, const VisibleParams& params) {
  std::priority_queue<Cell, std::vector<Cell>, SmallerError> open;
  VisibleExchange sum;
  ErrorSum errors;
  const auto take = [&](Cell cell) {
    ++sum.cells;
    sum.value += cell.value;
    errors.add(cell, 1);
    if (!cell.blockers.empty()) open.push(std::move(cell));
  };
  for (size_t i = 2; i < a.size(); ++i) take(evaluate(pair, {a[0], a[i - 1], a[i]}, blockers));
  const double least = pair.tolerance * std::max(params.negligible_m2, 1e-3 * unoccluded);
  const auto is_rough = [&] {
    return !open.empty() && errors.total() > std::max(least, pair.tolerance * sum.value);
  };
  while (is_rough() && sum.cells < params.max_cells &&
         !(params.progress && params.progress->cancelled())) {
    const Cell parent = open.top();
    open.pop();
    std::vector<Cell> children = split(pair, parent);
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

/// The exchange area serves both directions. Points are put on the polygon on which shadows end
/// less sharply, which is the one that blockers are farther from, or the smaller one.
void choose_side(Polygon& a, std::span<const uint32_t> blockers, PairIntegral& pair) {
  const auto lines_on = [&](PolygonView on, PolygonView light) {
    return shadow_lines(plane_of(on), light, pair.blockers, blockers, pair.slack);
  };
  ShadowLines swapped = lines_on(pair.b, a);
  pair.lines = lines_on(a, pair.b);
  const auto radius = [](PolygonView polygon) {
    return radius_about(mean_corner(polygon), polygon);
  };
  if (narrowest_penumbra(swapped, radius(pair.b)) <= narrowest_penumbra(pair.lines, radius(a)))
    return;
  std::swap(a, pair.b);
  pair.lines = std::move(swapped);
  pair.normal = plane_of(a).normal;
}

}  // namespace

VisibleExchange visible_exchange_area(PolygonView a, PolygonView b,
                                      std::span<const Blocker> blockers,
                                      const VisibleParams& params) {
  const Plane plane_a = plane_of(a), plane_b = plane_of(b);
  if (plane_a.normal == DVec3{} || plane_b.normal == DVec3{}) return {};
  PairIntegral pair{{}, blockers, plane_a.normal, params.tolerance, params.slack_m, {}, {}, {}};
  pair.slack = std::max(params.slack_m, 1e-13 * std::max(magnitude(a), magnitude(b)));
  pair.b = clip_above(b, plane_a, pair.slack);
  Polygon front_a = clip_above(a, plane_b, pair.slack);
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
  choose_side(front_a, reaching, pair);
  return refine(pair, front_a, reaching, unoccluded.value, params);
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
