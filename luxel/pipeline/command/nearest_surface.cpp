#include "luxel/pipeline/command/nearest_surface.h"

#include <algorithm>
#include <array>

#include "luxel/transport/elements.h"

namespace luxel::pipeline {
namespace {

/// The cosine of 45 degrees.
constexpr float kSurfaceAlike = 0.7071f;
/// Barycentric coordinates are no smaller: on an edge light is the limit from inside.
constexpr float kInwards = 1e-4f;

/// Barycentric coordinates of the nearest point of a segment from `a`, for corner b.
float along(Vec3 a, Vec3 b, Vec3 p) {
  const Vec3 d = b - a;
  return std::clamp(dot(p - a, d) / std::max(dot(d, d), 1e-30f), 0.0f, 1.0f);
}

/// The nearest point of a triangle: the foot of the perpendicular, or the best of the edges'.
Barycentric nearest_in(const scene::Triangle3& t, Vec3 p) {
  const Vec3 u = t.b - t.a, v = t.c - t.a, w = p - t.a;
  const float uu = dot(u, u), uv = dot(u, v), vv = dot(v, v), wu = dot(w, u), wv = dot(w, v);
  const float det = uu * vv - uv * uv;
  if (det > 0) {
    const float b = (vv * wu - uv * wv) / det, c = (uu * wv - uv * wu) / det;
    if (b >= 0 && c >= 0 && b + c <= 1) return {b, c};
  }
  const float ab = along(t.a, t.b, p), bc = along(t.b, t.c, p), ca = along(t.c, t.a, p);
  const std::array<Barycentric, 3> edges{{{ab, 0}, {1 - bc, bc}, {0, 1 - ca}}};
  return *std::min_element(edges.begin(), edges.end(), [&](Barycentric x, Barycentric y) {
    return length(interpolate(t.a, t.b, t.c, x) - p) < length(interpolate(t.a, t.b, t.c, y) - p);
  });
}

Barycentric inside_of(Barycentric at) {
  const float u = std::max(at.u, kInwards), v = std::max(at.v, kInwards);
  const float rest = std::max(1 - at.u - at.v, kInwards), sum = rest + u + v;
  return {u / sum, v / sum};
}

/// 1: the front is meant, -1: the back; 0: neither faces there.
float side_meant(const scene::Material& material, Vec3 front, Vec3 towards,
                 std::optional<Vec3> facing) {
  const bool two_sided = scene::reflects_from_behind(material);
  if (facing) {
    const float cosine = dot(front, normalize(*facing));
    if (cosine >= kSurfaceAlike) return 1;
    return two_sided && cosine <= -kSurfaceAlike ? -1.0f : 0.0f;
  }
  return two_sided && dot(front, towards) < 0 ? -1.0f : 1.0f;
}

}  // namespace

NearestSurface nearest_surface(const scene::Scene& scene, Vec3 at, std::optional<Vec3> facing) {
  NearestSurface best;
  float best_side = 1;
  for (uint32_t i = 0; i < scene.instances.size(); ++i) {
    const scene::Mesh& mesh = scene.meshes[scene.instances[i].mesh];
    for (uint32_t k = 0; k < mesh.triangles.size(); ++k) {
      const scene::Triangle3 t = scene::world_triangle(scene, i, k);
      const Barycentric place = nearest_in(t, at);
      const float distance = length(interpolate(t.a, t.b, t.c, place) - at);
      if (distance >= best.distance_m) continue;
      const Vec3 front = scene::front_normal(scene, i, k);
      if (!(dot(front, front) > 0)) continue;
      const float side = side_meant(scene.materials[mesh.triangle_material[k]], front,
                                    at - interpolate(t.a, t.b, t.c, place), facing);
      if (side == 0) continue;
      best.point = {i, k, inside_of(place)}, best.distance_m = distance, best_side = side;
    }
  }
  if (best.distance_m == INFINITY) return best;
  const transport::SmoothPoint smooth = transport::smooth_point(scene, best.point, best_side);
  best.position = smooth.position, best.start = smooth.start;
  best.normal = smooth.normal, best.geometric_normal = smooth.geometric_normal;
  return best;
}

}  // namespace luxel::pipeline
