#include "luxel/viewfactor/random_contacts.h"

#include <algorithm>
#include <cmath>

#include "luxel/base/random.h"
#include "luxel/viewfactor/polygon_form_factor.h"

namespace luxel::viewfactor {
namespace {

struct ContactDice {
  uint64_t seed;
  uint64_t& index;

  /// Uniform in [-1, 1), with all bits of a double.
  double number() { return double(int64_t(hash64(seed, index++))) * 0x1p-63; }
};

/// Facing up, or down when `down`.
Polygon contact_plate(double x0, double y0, double x1, double y1, double z, bool down = false) {
  Polygon p{{x0, y0, z}, {x1, y0, z}, {x1, y1, z}, {x0, y1, z}};
  if (down) std::reverse(p.begin(), p.end());
  return p;
}

Polygon turned_over(Polygon p) {
  std::reverse(p.begin(), p.end());
  return p;
}

/// Exchange area of both sides of a polygon with the front of another.
double both_sides(const Polygon& s, const Polygon& b) {
  return polygon_exchange_area(s, b).value + polygon_exchange_area(turned_over(s), b).value;
}

/// A box in the plane of a.
struct ShadowBox {
  double x0 = 1e9, y0 = 1e9, x1 = -1e9, y1 = -1e9;
  bool lies_in(double half) const { return x0 > -half && y0 > -half && x1 < half && y1 < half; }
  bool meets(const ShadowBox& o) const { return x0 < o.x1 && o.x0 < x1 && y0 < o.y1 && o.y0 < y1; }
};

/// The box about the shadow of s on the plane z = 0 with b as the light. Not finite where s
/// is not between them.
ShadowBox shadow_box(const Polygon& s, const Polygon& b) {
  ShadowBox box;
  for (const DVec3& eye : b)
    for (const DVec3& p : s) {
      const double share = eye.z / (eye.z - p.z);
      if (!(share >= 1)) return {-INFINITY, -INFINITY, INFINITY, INFINITY};
      const DVec3 at = eye + (p - eye) * share;
      box.x0 = std::min(box.x0, at.x), box.x1 = std::max(box.x1, at.x);
      box.y0 = std::min(box.y0, at.y), box.y1 = std::max(box.y1, at.y);
    }
  return box;
}

Polygon upside_down(Polygon p, double height) {
  for (DVec3& corner : p) corner.z = height - corner.z;
  return p;
}

double uniform_of(ContactDice& dice) { return 0.5 + 0.5 * dice.number(); }
/// 10^from to 10^to, evenly in the logarithm.
double decades_of(ContactDice& dice, double from, double to) {
  return std::pow(10, from + (to - from) * uniform_of(dice));
}

/// A plate, a tilted one, a wall or a sliver whose lowest edge is at z = `height`. What touches z =
/// 0 is not parallel to it: a plate that lies on a polygon is neither above nor below it.
Polygon near_blocker(ContactDice& dice, double height) {
  const double size = decades_of(dice, -1.5, 0), turn = kPiDouble * dice.number();
  const double width =
      uniform_of(dice) < 0.3 ? size * decades_of(dice, -3, -1) : size * uniform_of(dice);
  const double kind = uniform_of(dice);
  const double tilt = kind < 0.4 && height > 0 ? 0
                      : kind < 0.7             ? 0.5 * kPiDouble
                                               : kPiDouble * uniform_of(dice);
  const DVec3 at{0.8 * dice.number(), 0.8 * dice.number(), height};
  const DVec3 u{size * std::cos(turn), size * std::sin(turn), 0};
  const DVec3 v{-std::sin(turn) * std::cos(tilt) * width, std::cos(turn) * std::cos(tilt) * width,
                std::sin(tilt) * width};
  return {at, at + u, at + u + v, at + v};
}

}  // namespace

/// Where no line from a to b meets two blockers, what they hide is what they themselves exchange
/// with b: each line from b to a blocker goes on to a. The shadows of the blockers near a lie
/// within a and do not meet, which makes it so. Lines that meet one near each of both polygons are
/// those between the two.
Contact random_contact(uint64_t seed, uint64_t& index) {
  ContactDice dice{seed, index};
  Contact c;
  const double height = decades_of(dice, -0.5, 0.3), half = decades_of(dice, -1.5, 0.3);
  c.a = contact_plate(-1, -1, 1, 1, 0);
  c.b = contact_plate(-half, -half, half, half, height, true);
  const auto add_near = [&](const Polygon& b, double half_a) {
    std::vector<Polygon> kept;
    std::vector<ShadowBox> shadows;
    const int wanted = 1 + int(3 * uniform_of(dice));
    for (int tries = 0; tries < 40 && int(kept.size()) < wanted; ++tries) {
      const double touching = uniform_of(dice) < 0.25 ? 0 : decades_of(dice, -6, -1);
      Polygon s = near_blocker(dice, touching * height);
      for (DVec3& p : s) p.x *= half_a, p.y *= half_a;
      const ShadowBox shadow = shadow_box(s, b);
      const auto meets = [&](const ShadowBox& o) { return o.meets(shadow); };
      if (!shadow.lies_in(half_a) || std::any_of(shadows.begin(), shadows.end(), meets)) continue;
      shadows.push_back(shadow), kept.push_back(s);
    }
    return kept;
  };
  const std::vector<Polygon> low = add_near(c.b, 1);
  std::vector<Polygon> high;
  if (uniform_of(dice) < 0.5) {
    for (const Polygon& t : add_near(upside_down(c.a, height), half)) {
      const auto goes_on = [&](const Polygon& s) {
        return shadow_box(s, upside_down(t, height)).lies_in(1) &&
               shadow_box(t, upside_down(s, height)).lies_in(half);
      };
      if (std::all_of(low.begin(), low.end(), goes_on)) high.push_back(upside_down(t, height));
    }
  }
  c.exact = polygon_exchange_area(c.a, c.b).value;
  for (const Polygon& s : low) c.exact -= both_sides(s, c.b);
  for (const Polygon& s : high) c.exact -= both_sides(s, c.a);
  for (const Polygon& s : low)
    for (const Polygon& t : high) c.exact += both_sides(s, t) + both_sides(s, turned_over(t));
  c.blockers = low;
  c.blockers.insert(c.blockers.end(), high.begin(), high.end());
  return c;
}

}  // namespace luxel::viewfactor
