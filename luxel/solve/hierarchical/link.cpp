#include "luxel/solve/hierarchical/link.h"

#include <algorithm>
#include <optional>

#include "luxel/base/parallel.h"
#include "luxel/base/random.h"
#include "luxel/scene/off_surface.h"
#include "luxel/viewfactor/point_form_factor.h"
#include "luxel/viewfactor/polygon_form_factor.h"

namespace luxel::hierarchical {
namespace {

/// Elements whose middles are nearer than this many times their radii exchange light that a few
/// points do not find the mean of: they get the closed form.
/// Larger computes closed forms where points would do; smaller errs for elements in a corner.
constexpr double kNear = 2.5;
/// The closed form's relative error, far below the error of the shadows that it is multiplied by.
constexpr double kClosedFormTolerance = 1e-4;
/// The error at which the closed form only tells whether two elements see each other at all.
constexpr double kAnyExchange = 1e-2;
/// Shadow rays of a link that involves a cluster, or more blockers than are looked at. The visible
/// share comes in steps of an eighth; links that carry enough light to show it are divided.
constexpr uint32_t kLinkRays = 8;
/// Gauss's two points of a side [0, 1] lie at (1 -+ 1 / sqrt 3) / 2.
constexpr double kGaussLow = 0.21132487, kGaussHigh = 0.78867513;
/// Gauss's points of a quadrilateral span a copy of it, smaller by 1 / sqrt 3; those of a triangle,
/// with the weights 2/3, 1/6, 1/6 of its corners, one smaller by 1 / 2. To the corners it is so
/// much further from the middle.
constexpr double kOutwards[2] = {1.7320508, 2};
/// Weights in spread_of(), the deviation of a form factor from linear over an element.
constexpr double kCornerOverMiddle = 2, kOddPart = 0.1;
/// Two balls exchange light as points do when the distance between their centres is at least so
/// many times the sum of their radii. The first-order error (see link_far) is half of the light
/// then, and beyond it terms of higher order would count as much.
constexpr double kFar = 2;
/// A guess may err by all that it brings, to one side for all that a surface gets from nearby: it
/// counts as so many times that.
constexpr float kGuessCounts = 4;
/// A closed body shows a quarter of its surface in the mean over all directions.
constexpr float kShown = 0.25f;

/// Where an element is looked from: Gauss's points.
struct Points {
  std::array<DVec3, 5> at;  ///< and last the middle
  uint32_t count = 0;       ///< without the middle
};
Points points_of(const Element& e) {
  Points out;
  const auto& c = e.corner;
  if (e.corners == 3) {
    out.count = 3;
    for (uint32_t k = 0; k < 3; ++k)
      out.at[k] = c[k] * (2.0 / 3) + (c[(k + 1) % 3] + c[(k + 2) % 3]) * (1.0 / 6);
    out.at[3] = e.centre;
    return out;
  }
  constexpr double low = kGaussLow, high = 1 - kGaussLow;
  out.count = 4;
  constexpr double s[4] = {low, high, high, low}, t[4] = {low, low, high, high};
  for (uint32_t k = 0; k < 4; ++k) out.at[k] = linear_at(c, 4, s[k], t[k]);
  out.at[4] = e.centre;
  return out;
}

/// The value at Gauss's point k of the function that is 1 at corner a, 0 at the others and linear
/// between. For a quadrilateral it is the product of the weights along its two sides.
double corner_weight(uint32_t corners, uint32_t a, uint32_t k) {
  if (corners == 3) return a == k ? 2.0 / 3 : 1.0 / 6;
  constexpr double near = kGaussHigh, far = kGaussLow;
  const uint32_t apart = (a + 4 - k) % 4;
  return apart == 0 ? near * near : apart == 2 ? far * far : near * far;
}

Vec3 lifted(const Face& face, DVec3 p, DVec3 side) {
  return scene::off_surface(to_float(p), to_float(side), face.size_m);
}

/// The share of pairs of points on two elements that see each other.
float seen_by_rays(const Exchange& x, const Element& r, const Element& s, uint64_t seed) {
  const Face &from_face = x.faces.faces[r.face], &to_face = x.faces.faces[s.face];
  std::array<trace::Ray, kLinkRays> rays;
  for (uint32_t k = 0; k < kLinkRays; ++k) {
    const DVec3 a = point_in(r, sobol_owen_2d(k, hash64(seed, 1)));
    const DVec3 b = point_in(s, sobol_owen_2d(k, hash64(seed, 2)));
    const DVec3 normal = to_face.plane.normal;
    const Vec3 from = lifted(from_face, a, from_face.plane.normal),
               to = lifted(to_face, b, to_face.plane.height(a) >= 0 ? normal : -normal);
    rays[k] = {from, 0, to - from, 1};
  }
  std::array<uint8_t, kLinkRays> blocked{};
  x.tracer.occluded(rays, blocked);
  return 1 - float(std::count(blocked.begin(), blocked.end(), 1)) / kLinkRays;
}

void find_blockers(const Exchange& x, const Element& r, const Element& s, const Link* parent,
                   Link& link) {
  if (parent && !parent->crowded)
    filter_between(x.blockers, r.polygon(), s.polygon(), parent->blockers, link.blockers);
  else
    find_between(x.blockers, r.polygon(), s.polygon(), link.blockers);
  std::erase(link.blockers, r.face), std::erase(link.blockers, s.face);
  if (link.blockers.size() > kMostBlockers || has_holes(x.faces, link.blockers))
    link.blockers.clear(), link.crowded = true;
}

/// Form factors of another element at an element's points, and at its middle.
struct Views {
  std::array<double, 5> whole{}, visible{};
  double whole_sum = 0, visible_sum = 0;  ///< without the middle
  uint32_t count = 0;

  double share() const { return whole_sum > 0 ? visible_sum / whole_sum : 1; }
};

Views look(const Exchange& x, const Element& from, const Element& at, const Link& link,
           viewfactor::VisibilityScratch& scratch) {
  Views out;
  const Plane& horizon = x.faces.faces[from.face].plane;
  const Face& face = x.faces.faces[at.face];
  const Points points = points_of(from);
  out.count = points.count;
  const Polygon front = viewfactor::clip_above(at.polygon(), horizon, x.blockers.slack_m);
  if (front.empty()) return out;
  const Polygon back(front.rbegin(), front.rend());
  static thread_local std::vector<uint8_t> casts;
  casts.resize(x.blockers.all.size());
  for (uint32_t k = 0; k <= points.count; ++k) {
    const bool behind = face.plane.height(points.at[k]) < 0;
    if (behind && !face.two_sided) continue;
    const Polygon& seen = behind ? back : front;
    out.whole[k] = viewfactor::point_to_polygon(points.at[k], horizon.normal, seen);
    out.visible[k] = out.whole[k];
    if (out.whole[k] > 0 && !link.blockers.empty())
      out.visible[k] = viewfactor::visible_point_factor(points.at[k], horizon.normal, seen,
                                                        {x.blockers.all, link.blockers},
                                                        x.blockers.slack_m, casts, scratch)
                           .visible;
    if (k < points.count) out.whole_sum += out.whole[k], out.visible_sum += out.visible[k];
  }
  return out;
}

/// The largest deviation of a form factor from linear over an element. A quadratic is the first
/// that linear functions miss. Let it be q x^2 across a quadrilateral, x from -1 to 1: it is q/3 at
/// all of Gauss's points, and so is the function fitted to them. The quadratic is 0 in the middle
/// and q at the edge, so the function is off by q/3 and 2q/3: twice as far as in the middle, where
/// it is measured. (For a triangle's corners it is three times as far.) A form factor that is odd
/// about the middle cannot show there: a border of a shadow through it, or a cubic. A tenth of the
/// points' differences stands for that. More would divide elements over which light is linear, and
/// for which the link is exact; with none a shadow's border that halves an element would go unseen.
double spread_of(const Views& v) {
  const auto [least, most] = std::minmax_element(v.visible.begin(), v.visible.begin() + v.count);
  return std::max(kCornerOverMiddle * std::abs(v.visible[v.count] - v.visible_sum / v.count),
                  kOddPart * (*most - *least));
}

/// The linear function through the points, moved so that it has the link's mean.
void set_receiver(const Views& v, Link& link) {
  const double mean = v.visible_sum / v.count;
  for (uint32_t k = 0; k < v.count; ++k)
    link.to[k] =
        mean > 0 ? float((1 + (v.visible[k] / mean - 1) * kOutwards[v.count == 3])) * link.factor
                 : link.factor;
}

/// The weights of the corners' radiosities when what the points see weighs those.
void set_source(const Views& v, Link& link) {
  for (uint32_t a = 0; a < v.count; ++a) {
    double sum = 0;
    for (uint32_t k = 0; k < v.count; ++k) sum += v.visible[k] * corner_weight(v.count, a, k);
    link.from[a] = v.visible_sum > 0 ? float(sum / v.visible_sum) : 1 / float(v.count);
  }
}

/// Between two elements: what points of the receiver see of the source, and the other way round.
Link link_elements(const Exchange& x, uint32_t receiver, uint32_t source, const Link* parent,
                   viewfactor::VisibilityScratch& scratch) {
  Link link{.source = source};
  const Element &r = x.tree.element(receiver), &s = x.tree.element(source);
  // Elements that do not face each other exchange nothing.
  if (r.face == s.face) return link;
  const Plane& r_plane = x.faces.faces[r.face].plane;
  const Face& s_face = x.faces.faces[s.face];
  const Polygon seen = viewfactor::clip_above(s.polygon(), r_plane, x.blockers.slack_m);
  if (seen.empty()) return link;
  const auto closed_form = [&](double tolerance) {
    return viewfactor::polygon_exchange_area(r.polygon(), seen, tolerance, x.blockers.slack_m)
        .value;
  };
  const bool near = length(r.centre - s.centre) < kNear * (r.radius_m + s.radius_m);
  if (!s_face.two_sided) {
    if (viewfactor::clip_above(r.polygon(), s_face.plane, x.blockers.slack_m).empty()) return link;
    if (near && !(closed_form(kAnyExchange) > 0)) return link;
  }
  // The source as the receiver's points see it: the visible share, and the mean form factor.
  find_blockers(x, r, s, parent, link);
  const Views there = look(x, r, s, link, scratch);
  if (!near && !(there.whole_sum > 0)) return link;
  link.visible =
      link.crowded ? seen_by_rays(x, r, s, hash64(receiver, source)) : float(there.share());
  const double mean = near && !s_face.two_sided ? closed_form(kClosedFormTolerance) / r.area_m2
                                                : there.whole_sum / there.count;
  link.factor = float(mean) * link.visible;
  // The weights of the receiver's corners, then of the source's.
  if (x.basis == Basis::constant)
    link.to.fill(link.factor);
  else
    set_receiver(there, link);
  Views back;
  back.count = s.corners;
  if (!s_face.two_sided) back = look(x, s, r, link, scratch);
  if (x.basis != Basis::linear) back.visible_sum = 0;  // corners count alike
  set_source(back, link);
  // Deviations of both from linear; by reciprocity as seen from the receiver.
  link.spread = float(spread_of(there));
  if (back.visible_sum > 0)
    link.spread = std::max(link.spread, float(spread_of(back) * s.area_m2 / r.area_m2));
  return link;
}

double area_of(const Tree& tree, uint32_t id) {
  return tree.is_cluster(id) ? tree.clusters[id].area_m2 : tree.element(id).area_m2;
}

struct Ball {
  DVec3 centre;
  double radius_m = 0;
};
Ball ball_of(const Tree& tree, uint32_t id) {
  if (tree.is_cluster(id)) return {tree.clusters[id].centre, tree.clusters[id].radius_m};
  const Element& e = tree.element(id);
  return {e.centre, e.radius_m};
}

/// A place on some element below that faces `other`: chance takes halves of clusters, and those
/// that turn their backs are not asked. Nothing after some trials.
std::optional<Vec3> place_facing(const Exchange& x, uint32_t id, DVec3 other,
                                 RandomStream& random) {
  constexpr int kTrials = 8;
  for (int k = 0; k < kTrials; ++k) {
    uint32_t at = id;
    while (x.tree.is_cluster(at)) at = x.tree.clusters[at].child[random.next() < 0.5f];
    const Element& e = x.tree.element(at);
    const Face& face = x.faces.faces[e.face];
    const DVec3 place = point_in(e, random.next2());
    if (face.plane.height(other) > 0) return lifted(face, place, face.plane.normal);
    if (face.two_sided) return lifted(face, place, -face.plane.normal);
  }
  return std::nullopt;
}

/// Pairs of points that face the other's middle, from the receiver to the source.
struct Pairs {
  std::array<trace::Ray, kLinkRays> rays;
  std::array<uint8_t, kLinkRays> blocked{};
  size_t count = 0;

  /// The share that see each other.
  float seen() const {
    if (count == 0) return 0;
    return 1 - float(std::count(blocked.begin(), blocked.end(), 1)) / float(count);
  }
};
Pairs pairs_between(const Exchange& x, uint32_t receiver, uint32_t source) {
  const DVec3 r = ball_of(x.tree, receiver).centre, s = ball_of(x.tree, source).centre;
  RandomStream random{hash64(receiver, source)};
  Pairs out;
  for (uint32_t k = 0; k < kLinkRays; ++k) {
    const auto from = place_facing(x, receiver, s, random);
    const auto to = place_facing(x, source, r, random);
    if (from && to) out.rays[out.count++] = {*from, 0, *to - *from, 1};
  }
  x.tracer.occluded({out.rays.data(), out.count}, {out.blocked.data(), out.count});
  return out;
}

/// From far away: a point that sends to a point.
Link link_far(const Exchange& x, uint32_t receiver, uint32_t source) {
  Link link{.source = source};
  const Ball r = ball_of(x.tree, receiver), s = ball_of(x.tree, source);
  const DVec3 d = s.centre - r.centre;
  const double distance = length(d);
  if (!(distance > 0)) {
    link.factor = link.spread = INFINITY;
    return link;
  }
  link.direction = to_float(d * (1 / distance));
  double cosine = 1;
  if (!x.tree.is_cluster(receiver)) {
    const DVec3 normal = x.faces.faces[x.tree.element(receiver).face].plane.normal;
    // The highest part of the source that the receiver's horizon lets through.
    if (dot(d, normal) + s.radius_m <= 0) return link;
    cosine = std::max(0.0, dot(d, normal) / distance);
  }
  if (distance < kFar * (r.radius_m + s.radius_m)) {  // too near for that: to be divided
    link.factor = link.spread = INFINITY;
    return link;
  }
  link.visible = pairs_between(x, receiver, source).seen();
  link.factor = float(cosine / (kPiDouble * distance * distance)) * link.visible;
  // Wrong by what distances and angles differ by over both, (r + s) / d of the exchange to first
  // order; and by shadows that fall on a part. If a share v is seen, some points may see all of it
  // and others nothing: with 2 min(v, 1 - v) a half that is seen counts as off by all of the light.
  const double part = (r.radius_m + s.radius_m) / distance;
  const double unseen = double(std::min(link.visible, 1 - link.visible));
  link.spread = float((part + 2 * unseen) / (kPiDouble * distance * distance));
  return link;
}

/// Light that an element or cluster sends along a direction: B A cos, summed [W].
Rgb sent_along(const Exchange& x, const Light& light, uint32_t id, Vec3 direction) {
  if (x.tree.is_cluster(id)) return light.clusters[id].sent.at(direction);
  const Element& e = x.tree.element(id);
  const Face& face = x.faces.faces[e.face];
  const float cosine = dot(to_float(face.plane.normal), direction);
  return light.elements[id - x.tree.clusters.size()].radiosity *
         (float(e.area_m2) * (face.two_sided ? std::abs(cosine) : std::max(0.0f, cosine)));
}

}  // namespace

Link make_link(const Exchange& x, uint32_t receiver, uint32_t source, const Link* parent,
               viewfactor::VisibilityScratch& scratch) {
  if (x.tree.is_cluster(receiver) || x.tree.is_cluster(source))
    return link_far(x, receiver, source);
  return link_elements(x, receiver, source, parent, scratch);
}

Link guess_link(const Exchange& x, uint32_t receiver, uint32_t source) {
  const DVec3 r = ball_of(x.tree, receiver).centre, s = ball_of(x.tree, source).centre;
  const Pairs pairs = pairs_between(x, receiver, source);
  Link link{.source = source, .spread = INFINITY, .visible = pairs.seen()};
  Vec3 towards{};
  float sum = 0;
  for (size_t k = 0; k < pairs.count; ++k) {
    if (pairs.blocked[k]) continue;
    const Vec3 d = pairs.rays[k].direction;
    float cosine = 1;
    if (!x.tree.is_cluster(receiver))
      cosine = std::max(
          0.0f,
          dot(to_float(x.faces.faces[x.tree.element(receiver).face].plane.normal), d) / length(d));
    // As from a disc as large as the source looks, which brings no more than its radiosity.
    const float share = cosine / (kPi * dot(d, d) + kShown * float(area_of(x.tree, source)));
    sum += share, towards += d * (share / length(d));
  }
  link.factor = pairs.count > 0 ? sum / float(pairs.count) : 0;
  if (!(dot(towards, towards) > 0)) towards = to_float(s - r);
  link.direction = dot(towards, towards) > 0 ? normalize(towards) : Vec3{0, 0, 1};
  return link;
}

/// The mean radiosity of a source element as its receiver sees it.
static Rgb sent_over(const Link& link, const Exchange& x, const Light& light) {
  const std::array<Rgb, 4>& b = light.elements[link.source - x.tree.clusters.size()].shining;
  return b[0] * link.from[0] + b[1] * link.from[1] + b[2] * link.from[2] + b[3] * link.from[3];
}

Rgb irradiance_of(const Link& link, const Exchange& x, const Light& light) {
  if (link.direction == Vec3{}) return sent_over(link, x, light) * link.factor;
  return sent_along(x, light, link.source, -link.direction) * link.factor;
}

/// [Hanrahan91] compares B F A, the power over a link, with a limit. Here the limit is eps on an
/// element of the unit's area, so that eps is what it is in [Hardt96]: W/m^2.
float error_of(const Link& link, uint32_t receiver, const Exchange& x, const Light& light) {
  if (std::isinf(link.spread))
    return std::isinf(link.factor) ? INFINITY : most_error_of(link.source, receiver, x, light);
  float error = 0;
  if (x.tree.is_cluster(link.source)) {
    error = max_component(sent_along(x, light, link.source, -link.direction)) * link.spread;
  } else {
    const ElementLight& l = light.elements[link.source - x.tree.clusters.size()];
    error = link.direction == Vec3{}
                ? std::max(l.most * link.spread, l.rough * link.factor)
                : l.most * float(x.tree.element(link.source).area_m2) * link.spread;
  }
  return error * float(area_of(x.tree, receiver) / x.unit_area_m2);
}

float most_error_of(uint32_t source, uint32_t receiver, const Exchange& x, const Light& light) {
  float most = 0, power = 0;
  if (x.tree.is_cluster(source)) {
    const ClusterLight& l = light.clusters[source];
    most = l.most, power = max_component(l.sent.zeroth);
  } else {
    const Element& e = x.tree.element(source);
    const ElementLight& l = light.elements[source - x.tree.clusters.size()];
    most = l.most;
    power = max_component(l.radiosity) * float(e.area_m2) *
            (x.faces.faces[e.face].two_sided ? 2.0f : 1.0f);
  }
  return kGuessCounts * std::min(most * float(area_of(x.tree, receiver)), power) /
         float(x.unit_area_m2);
}

void gather(const Exchange& x, std::span<const std::vector<Link>> links, Light& light) {
  const size_t clusters = x.tree.clusters.size();
  parallel_for(links.size(), 256, [&](size_t begin, size_t end) {
    for (size_t id = begin; id < end; ++id) {
      if (id < clusters) {
        // A cluster keeps where its light comes from.
        Cosines& received = light.clusters[id].received;
        received = {};
        for (const Link& link : links[id])
          received.add(link.direction, irradiance_of(link, x, light));
        continue;
      }
      // An element gets a linear function from elements, and a constant from clusters.
      std::array<Rgb, 4> sum{};
      for (const Link& link : links[id]) {
        if (link.direction == Vec3{}) {
          const Rgb b = sent_over(link, x, light);
          for (size_t k = 0; k < 4; ++k) sum[k] += b * link.to[k];
        } else {
          const Rgb e = irradiance_of(link, x, light);
          for (Rgb& corner : sum) corner += e;
        }
      }
      light.elements[id - clusters].received = sum;
    }
  });
}

}  // namespace luxel::hierarchical
