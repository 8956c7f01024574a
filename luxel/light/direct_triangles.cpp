// Shadow rays towards emissive triangles.
#include <algorithm>

#include "luxel/base/random.h"
#include "luxel/light/both_triangle_light.h"
#include "luxel/light/light_draw.h"
#include "luxel/light/shadow_rays.h"
#include "luxel/light/spherical_triangle.h"
#include "luxel/scene/off_surface.h"

namespace luxel::light {
namespace {

both::LightTriangle triangle_of(const TriangleLight& light) {
  return {light.a, light.b, light.c, light.normal, light.area_m2, light.two_sided};
}

float irradiance_per_radiance(const TriangleLight& light, Vec3 position, Vec3 normal) {
  return both::irradiance_per_radiance(triangle_of(light), position, normal);
}

using both::LightPoint;

void aim_at_point(const DirectScene& lit, const TriangleLight& light, const LightPoint& point,
                  uint32_t source, float factor, const Receiver& r, ShadowRayBatch& batch) {
  const bool front = dot(r.position - light.a, light.normal) > 0;
  // The ray ends just before the light, so that the light itself does not block it, nor a wall that
  // touches the light when the point lies on their common edge.
  constexpr float kEnd = 1 - 1e-4f;
  const Vec3 end =
      scene::off_surface(point.target, front ? light.normal : -light.normal, light.size_m);
  const Rgb radiance = light.textured ? radiance_at(lit.scene, light, {point.at.x, point.at.y})
                                      : light.mean_radiance;
  const float w = point.weight * factor;
  add_shadow_ray(batch, r, {source, w, radiance * w}, end - r.position, kEnd);
}

/// Shadow rays at one triangle. Points below the receiver's horizon bring nothing and would starve
/// the ratio: the sequence is followed until `count` points lie above it.
void aim_at_triangle(const DirectScene& lit, const TriangleLight& light, uint32_t source,
                     uint32_t count, const Receiver& r, ShadowRayBatch& batch) {
  const both::LightTriangle triangle = triangle_of(light);
  const auto spherical = spherical_triangle(r.position, light.a, light.b, light.c);
  uint64_t seed = hash64(r.seed, (uint64_t(light.instance) << 32) | light.triangle);
  if (light.piece > 0) seed = hash64(seed, light.piece);
  uint32_t kept = 0;
  for (uint32_t k = 0; kept < count && k < 8 * count + 64; ++k) {
    const LightPoint point =
        both::point_of_light(triangle, spherical, r.position, r.normal, sobol_owen_2d(k, seed));
    if (point.weight <= 0) continue;
    aim_at_point(lit, light, point, source, 1, r, batch);
    ++kept;
  }
}

bool shines_on(const TriangleLight& light, const Receiver& r) {
  return light.two_sided || dot(r.position - light.a, light.normal) > 0;
}

/// One shadow ray at a triangle that stands for many.
void aim_at_drawn(const DirectScene& lit, const LightDraw& draw, const Receiver& r,
                  ShadowRayBatch& batch) {
  const TriangleLight& light = lit.lights.triangles[draw.light];
  const uint32_t source = uint32_t(batch.sources.size());
  batch.sources.push_back(
      {.scale = 1 / draw.chance, .drawn = true, .light = {LightId::Kind::triangle, draw.light}});
  const auto spherical = spherical_triangle(r.position, light.a, light.b, light.c);
  const uint64_t seed = hash64(r.seed, (uint64_t(light.instance) << 32) | light.triangle);
  const LightPoint point = both::point_of_light(triangle_of(light), spherical, r.position, r.normal,
                                                RandomStream{seed}.next2());
  if (point.weight > 0 && shines_on(light, r))
    aim_at_point(lit, light, point, source, point.measure, r, batch);
}

/// More lights than a cut holds: some of them. Those that get a ray for certain are exact but for
/// the visible share; of the others each one that is drawn stands for its neighbours too.
void aim_at_drawn_triangles(const DirectScene& lit, int samples, const Receiver& r,
                            ShadowRayBatch& batch) {
  const auto leaf = [&](const LightNode& node) {
    return importance_at(node, r.position, r.normal);
  };
  RandomStream random{hash64(r.seed, 0x11)};
  // A cut shares several rays out better; for a single one the way down from the root is enough.
  const DrawParams params{
      .samples = samples, .max_cut = samples == 1 ? 1u : both::kMaxCut, .start = random.next()};
  draw_lights(lit.lights.nodes, r.position, r.normal, leaf, params, batch.draws);
  for (const LightDraw& draw : batch.draws.draws) {
    if (draw.chance < 1) {
      aim_at_drawn(lit, draw, r, batch);
      continue;
    }
    const TriangleLight& light = lit.lights.triangles[draw.light];
    const float whole = irradiance_per_radiance(light, r.position, r.normal);
    if (whole <= 0) continue;
    const uint32_t source = uint32_t(batch.sources.size());
    batch.sources.push_back({.scale = whole,
                             .exact = true,
                             .planned = draw.count,
                             .unshadowed = whole * luminance(light.mean_radiance),
                             .light = {LightId::Kind::triangle, draw.light}});
    aim_at_triangle(lit, light, source, draw.count, r, batch);
  }
}

/// Few lights: `samples` shadow rays are shared out in proportion to what each brings, at least one
/// to each while there are twice as many shadow rays as lights. Where there are fewer, a light that
/// deserves less than one gets one with that chance (systematic sampling), and counts for more
/// then.
void aim_at_all_triangles(const DirectScene& lit, int samples, const Receiver& r,
                          ShadowRayBatch& batch) {
  batch.whole.clear();
  float total = 0;
  size_t shining = 0;
  for (const TriangleLight& light : lit.lights.triangles) {
    batch.whole.push_back(irradiance_per_radiance(light, r.position, r.normal));
    total += batch.whole.back() * luminance(light.mean_radiance);
    shining += batch.whole.back() > 0;
  }
  if (!(total > 0)) return;
  RandomStream random{hash64(r.seed, 0x11)};
  float owed = random.next();
  const float least = size_t(samples) >= 2 * shining ? 1.0f : 0.0f;
  for (size_t i = 0; i < lit.lights.triangles.size(); ++i) {
    if (batch.whole[i] <= 0) continue;
    const TriangleLight& light = lit.lights.triangles[i];
    const float unshadowed = batch.whole[i] * luminance(light.mean_radiance);
    const float deserved = std::max(least, float(samples) * unshadowed / total);
    uint32_t count = uint32_t(std::lround(deserved));
    if (deserved < 1) {
      owed += deserved;
      count = owed >= 1 ? 1 : 0;
      owed -= float(count);
    }
    if (count == 0) continue;
    const float chance = std::min(1.0f, deserved);
    const uint32_t source = uint32_t(batch.sources.size());
    batch.sources.push_back({.scale = batch.whole[i] / chance,
                             .exact = true,
                             .planned = count,
                             .unshadowed = unshadowed / chance,
                             .light = {LightId::Kind::triangle, uint32_t(i)}});
    aim_at_triangle(lit, light, source, count, r, batch);
  }
}

}  // namespace

void aim_at_triangles(const DirectScene& lit, int samples, const Receiver& r,
                      ShadowRayBatch& batch) {
  if (lit.lights.triangles.empty()) return;
  if (lit.lights.triangles.size() <= both::kMaxAllTriangles)
    aim_at_all_triangles(lit, samples, r, batch);
  else
    aim_at_drawn_triangles(lit, samples, r, batch);
}

}  // namespace luxel::light
