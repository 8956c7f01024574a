#include "transport/point_form_factor.h"

#include <array>
#include <cmath>

#include "base/check.h"

namespace luxel::transport {
namespace {

struct Dir3 {
  double x, y, z;
};
double dot(const Dir3& a, const Dir3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Dir3 cross(const Dir3& a, const Dir3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

constexpr size_t kMaxCorners = 5;  // a quad cut by one plane

/// The part of the polygon above the element's plane (Sutherland and Hodgman's clip). Returns the
/// number of corners.
size_t clip_to_horizon(std::span<const Dir3> polygon, const Dir3& normal,
                       std::array<Dir3, kMaxCorners>& out) {
  size_t count = 0;
  for (size_t i = 0; i < polygon.size(); ++i) {
    const Dir3& p = polygon[i];
    const Dir3& q = polygon[(i + 1) % polygon.size()];
    const double hp = dot(p, normal), hq = dot(q, normal);
    if (hp >= 0) out[count++] = p;
    if ((hp > 0 && hq < 0) || (hp < 0 && hq > 0)) {
      const double t = hp / (hp - hq);
      out[count++] = {p.x + t * (q.x - p.x), p.y + t * (q.y - p.y), p.z + t * (q.z - p.z)};
    }
  }
  return count;
}

}  // namespace

double point_to_polygon(Vec3 point, Vec3 normal, std::span<const Vec3> polygon) {
  LUXEL_CHECK(polygon.size() >= 3 && polygon.size() <= 4);
  std::array<Dir3, 4> corners;
  for (size_t i = 0; i < polygon.size(); ++i)
    corners[i] = {double(polygon[i].x) - point.x, double(polygon[i].y) - point.y,
                  double(polygon[i].z) - point.z};
  const Dir3 n{normal.x, normal.y, normal.z};
  std::array<Dir3, kMaxCorners> above;
  const size_t count = clip_to_horizon({corners.data(), polygon.size()}, n, above);
  if (count < 3) return 0;
  double sum = 0;
  for (size_t i = 0; i < count; ++i) {
    const Dir3& p = above[i];
    const Dir3& q = above[(i + 1) % count];
    const Dir3 edge = cross(p, q);
    const double sine = std::sqrt(dot(edge, edge));
    if (sine > 0) sum += std::atan2(sine, dot(p, q)) * dot(edge, n) / sine;
  }
  // Corners that are counter-clockwise seen from the point run clockwise about the direction to it.
  return std::max(0.0, -sum / (2 * 3.14159265358979323846));
}

}  // namespace luxel::transport
