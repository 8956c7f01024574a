// Random polygons and rooms for tests.
#pragma once

#include <array>
#include <vector>

#include "luxel/base/random.h"
#include "luxel/viewfactor/polygon.h"

namespace luxel::viewfactor {

/// p -> scale * rotation * p + shift
struct Motion {
  std::array<DVec3, 3> rows;
  DVec3 shift;
  double scale = 1;
};
inline Polygon moved(const Polygon& polygon, const Motion& m) {
  Polygon out;
  for (const DVec3& p : polygon)
    out.push_back((DVec3{dot(m.rows[0], p), dot(m.rows[1], p), dot(m.rows[2], p)} + m.shift) *
                  m.scale);
  return out;
}

struct Dice {
  uint64_t seed = 1, index = 0;

  /// Uniform in [-1, 1), with all bits of a double.
  double number() { return double(int64_t(hash64(seed, index++))) * 0x1p-63; }
  DVec3 point() { return {number(), number(), number()}; }
  DVec3 direction() {
    for (;;)
      if (const DVec3 p = point(); length(p) <= 1 && length(p) > 0.1) return normalize(p);
  }
  DVec3 normal_to(DVec3 axis) { return normalize(cross(axis, direction())); }
  Polygon rectangle(DVec3 corner, double size) {
    const DVec3 x = direction(), y = normal_to(x);
    const DVec3 u = x * (size * (0.1 + std::abs(number()))),
                v = y * (size * (0.1 + std::abs(number())));
    return {corner, corner + u, corner + u + v, corner + v};
  }
  Motion motion(double scale) {
    const DVec3 x = direction(), y = normal_to(x);
    return {{x, y, cross(x, y)}, point(), scale};
  }
  /// The inside of the polyhedron that `count` random planes at distance 1 or less from the origin
  /// and a cube around it cut out; fronts look inwards.
  std::vector<Polygon> convex_room(int count) {
    std::vector<Plane> planes;
    for (int axis = 0; axis < 3; ++axis)
      for (const double side : {-1.0, 1.0})
        planes.push_back(
            {DVec3{axis == 0 ? side : 0, axis == 1 ? side : 0, axis == 2 ? side : 0}, -1.5});
    for (int i = 0; i < count; ++i) planes.push_back({direction(), -0.6 - 0.4 * number()});
    std::vector<Polygon> faces;
    for (const Plane& plane : planes) {
      const DVec3 x = normal_to(plane.normal), y = cross(plane.normal, x);
      const DVec3 o = plane.normal * plane.offset;
      Polygon face{o - x * 10 - y * 10, o + x * 10 - y * 10, o + x * 10 + y * 10,
                   o - x * 10 + y * 10};
      for (const Plane& other : planes)
        if (&other != &plane && !face.empty()) face = clip_above(face, other, 1e-13);
      if (!face.empty()) faces.push_back(face);
    }
    return faces;
  }
};

/// The two parts of a polygon at a random plane through its middle.
inline std::vector<Polygon> halves(const Polygon& polygon, Dice& dice) {
  const DVec3 normal = dice.direction();
  const Plane plane{normal, dot(normal, mean_corner(polygon))};
  return {clip_above(polygon, plane, 0), clip_above(polygon, {-normal, -plane.offset}, 0)};
}

}  // namespace luxel::viewfactor
