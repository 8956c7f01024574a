// Shadow rays towards emissive triangles.
#include <algorithm>

#include "base/random.h"
#include "base/warp.h"
#include "transport/direct_shots.h"
#include "transport/spherical_triangle.h"

namespace luxel::transport {
namespace {

constexpr size_t kMaxCut = 32;
/// Below it a triangle is so small that sampling its area is as good, and more exact in floats.
constexpr float kMinSolidAngle = 1e-3f;

/// One point of a triangle light: w = cos (solid angle density) or cos cos / d^2 (area density);
/// both up to a constant of the light, `measure`, which a group needs and an exact source does not.
struct LightPoint {
  Vec3 target;
  Barycentric at;
  float weight = 0, measure = 0;
};

LightPoint sample_solid_angle(const TriangleLight& light, const SphericalTriangle& spherical,
                              const Receiver& r, Vec2 u) {
  const Vec3 d = spherical_triangle_sample(spherical, u);
  const float along = dot(d, light.normal);
  const float t = along != 0 ? dot(light.a - r.position, light.normal) / along : 0.0f;
  const Vec3 p = r.position + d * t;
  const Vec3 ab = light.b - light.a, ac = light.c - light.a, ap = p - light.a;
  const Vec3 n = cross(ab, ac);
  const float inverse = 1 / dot(n, n);
  return {p,
          {dot(cross(ap, ac), n) * inverse, dot(cross(ab, ap), n) * inverse},
          std::max(0.0f, dot(d, r.normal)),
          spherical.solid_angle};
}

LightPoint sample_area(const TriangleLight& light, const Receiver& r, Vec2 u) {
  const Barycentric at = triangle_sample(u);
  const Vec3 p = interpolate(light.a, light.b, light.c, at);
  const Vec3 d = p - r.position;
  const float d2 = dot(d, d);
  float light_side = -dot(d, light.normal);
  if (light.two_sided) light_side = std::abs(light_side);
  if (d2 <= 0 || light_side <= 0) return {p, at, 0, light.area_m2};
  return {p, at, std::max(0.0f, dot(d, r.normal)) * light_side / (d2 * d2), light.area_m2};
}

void shoot_at(const scene::Scene& scene, const TriangleLight& light, const LightPoint& point,
              uint32_t source, float factor, const Receiver& r, float diagonal_m, Shots& shots) {
  const bool front = dot(r.position - light.a, light.normal) > 0;
  // The ray ends just before the light, so that the light itself does not block it, nor a wall that
  // touches the light when the point lies on their common edge.
  constexpr float kEnd = 1 - 1e-4f;
  const Vec3 end =
      trace::offset_origin(point.target, front ? light.normal : -light.normal, diagonal_m);
  const Rgb radiance = light.textured ? radiance_at(scene, light, point.at) : light.mean_radiance;
  const float w = point.weight * factor;
  add_shot(shots, r, {source, w, radiance * w}, end - r.origin, kEnd);
}

/// Shots at one triangle. Points below the receiver's horizon bring nothing and would starve the
/// ratio: the sequence is followed until `count` points lie above it.
void shoot_at_triangle(const scene::Scene& scene, const TriangleLight& light, uint32_t source,
                       uint32_t count, const Receiver& r, float diagonal_m, Shots& shots) {
  const auto spherical = spherical_triangle(r.position, light.a, light.b, light.c);
  const bool by_angle = spherical.solid_angle > kMinSolidAngle;
  uint64_t seed = hash64(r.seed, (uint64_t(light.instance) << 32) | light.triangle);
  if (light.piece > 0) seed = hash64(seed, light.piece);
  uint32_t kept = 0;
  for (uint32_t k = 0; kept < count && k < 8 * count + 64; ++k) {
    const Vec2 u = sobol_owen_2d(k, seed);
    const LightPoint point =
        by_angle ? sample_solid_angle(light, spherical, r, u) : sample_area(light, r, u);
    if (point.weight <= 0) continue;
    shoot_at(scene, light, point, source, 1, r, diagonal_m, shots);
    ++kept;
  }
}

/// Shots at a group: a triangle in proportion to its power, a point on it by area.
void shoot_at_group(const scene::Scene& scene, const Lights& lights, const LightNode& node,
                    uint32_t source, uint32_t count, const Receiver& r, float diagonal_m,
                    Shots& shots) {
  const float low = lights.power_below[node.first];
  const float high = lights.power_below[node.first + node.count];
  RandomStream random{hash64(r.seed, node.first + (uint64_t(node.count) << 32))};
  for (uint32_t k = 0; k < count; ++k) {
    const float power = low + (high - low) * ((float(k) + random.next()) / float(count));
    const auto begin = lights.power_below.begin() + node.first + 1;
    const auto found = std::upper_bound(begin, begin + node.count - 1, power);
    const size_t index = node.first + size_t(found - begin);
    const TriangleLight& light = lights.triangles[index];
    const float chance = (lights.power_below[index + 1] - lights.power_below[index]) / (high - low);
    const LightPoint point = sample_area(light, r, random.next2());
    if (point.weight > 0 && chance > 0)
      shoot_at(scene, light, point, source, point.measure / chance, r, diagonal_m, shots);
  }
}

}  // namespace

/// Shares `samples` shots out over the cut in proportion to importance, at least one to each entry
/// while there are twice as many shots as entries. Where there are fewer, an entry that deserves
/// less than one gets one with that chance (systematic sampling), and counts for more then.
void shoot_at_triangles(const scene::Scene& scene, const Lights& lights, int samples,
                        const Receiver& r, float diagonal_m, Shots& shots) {
  light_cut(lights, r.position, r.normal, kMaxCut, shots.cut);
  float total = 0;
  for (const CutEntry& entry : shots.cut) total += entry.importance;
  if (!(total > 0)) return;
  RandomStream random{hash64(r.seed, 0x11)};
  float owed = random.next();
  const float least = size_t(samples) >= 2 * shots.cut.size() ? 1.0f : 0.0f;
  for (const CutEntry& entry : shots.cut) {
    const float deserved = std::max(least, float(samples) * entry.importance / total);
    uint32_t count = uint32_t(std::lround(deserved));
    if (deserved < 1) {
      owed += deserved;
      count = owed >= 1 ? 1 : 0;
      owed -= float(count);
    }
    if (count == 0) continue;
    const float chance = std::min(1.0f, deserved);
    const LightNode& node = lights.nodes[entry.node];
    const uint32_t source = uint32_t(shots.sources.size());
    Source s;
    s.exact = entry.exact;
    s.scale = entry.exact ? entry.irradiance_per_radiance / chance : 1 / (float(count) * chance);
    s.unshadowed = entry.importance / chance;
    shots.sources.push_back(s);
    if (entry.exact)
      shoot_at_triangle(scene, lights.triangles[node.first], source, count, r, diagonal_m, shots);
    else
      shoot_at_group(scene, lights, node, source, count, r, diagonal_m, shots);
  }
}

}  // namespace luxel::transport
