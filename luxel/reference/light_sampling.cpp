#include "luxel/reference/light_sampling.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "luxel/base/parallel.h"
#include "luxel/base/vec_double.h"
#include "luxel/base/warp.h"
#include "luxel/scene/both_off_surface.h"
#include "luxel/scene/light_kinds.h"

namespace luxel::reference {
namespace {

constexpr double kLeastTexturedShare = 0.01;

/// Mean luminance over the centres of 8 x 8 congruent parts of the triangle.
double mean_luminance(const scene::Scene& scene, uint32_t instance, uint32_t triangle) {
  constexpr int kParts = 8;
  double sum = 0;
  for (int j = 0; j < kParts; ++j)
    for (int i = 0; i < kParts - j; ++i) {
      const auto add = [&](float third) {
        const Barycentric at{(float(i) + third) / kParts, (float(j) + third) / kParts};
        sum += double(luminance(scene::emission_at(scene, {instance, triangle, at})));
      };
      add(1.0f / 3);
      if (i + j < kParts - 1) add(2.0f / 3);  // the part that stands on its head
    }
  return sum / (kParts * kParts);
}

double power_of(const scene::Scene& scene, const Emitter& emitter) {
  const scene::Material& material =
      scene::material_at(scene, {emitter.instance, emitter.triangle, {}});
  double mean = double(luminance(material.emission));
  if (material.emission_texture.texture != scene::kNone)
    mean = std::max(kLeastTexturedShare * mean,
                    mean_luminance(scene, emitter.instance, emitter.triangle));
  return mean * double(scene::area_m2(emitter.corners)) * (emitter.two_sided ? 2 : 1);
}

/// [0, 1) with 48 bits: a stair of 2^24 steps would skip small lights among many.
double fine_number(RandomStream& random) {
  const Vec2 u = random.next2();
  return double(u.x) + double(u.y) * 0x1p-24;
}

EmitterPoint point_on(const Emitter& e, Vec2 u) {
  const Barycentric at = triangle_sample(u);
  return {&e, at, interpolate(e.corners.a, e.corners.b, e.corners.c, at)};
}

/// To a float of [0, 1).
float below_one(double u) { return std::clamp(float(u), 0.0f, 1 - 0x1p-24f); }

/// The triangle whose share of the chances u falls into; u in [0, 1).
size_t pick(std::span<const double> below, double u) {
  const auto found = std::upper_bound(below.begin() + 1, below.end() - 1, u * below.back());
  return size_t(found - below.begin()) - 1;
}

/// KHR_lights_punctual: I / d^2, a window that reaches zero at the range, a squared ramp in the
/// cosine between the spot's cones; a profile's candela.
float falloff(const scene::Scene& scene, const scene::PunctualLight& punctual, Vec3 towards,
              float distance) {
  float f = 1 / (distance * distance);
  if (punctual.profile != scene::kNone)
    f *= scene::candela_at(scene.profiles[punctual.profile], punctual.direction, punctual.side,
                           -towards);
  if (punctual.range_m > 0)
    f *= std::clamp(1 - std::pow(distance / punctual.range_m, 4.0f), 0.0f, 1.0f);
  if (!scene::has_cone(punctual.kind)) return f;
  const float outer = std::cos(punctual.outer_cone_rad);
  const float width = std::max(0.001f, std::cos(punctual.inner_cone_rad) - outer);
  const float ramp = std::clamp((dot(-towards, punctual.direction) - outer) / width, 0.0f, 1.0f);
  return f * ramp * ramp;
}

LightSample light_from_point(const scene::Scene& scene, const scene::PunctualLight& punctual,
                             Vec3 position) {
  const Vec3 to_light = punctual.position - position;
  const float distance = length(to_light);
  if (!(distance > 0)) return {};
  const Vec3 towards = to_light / distance;
  return {punctual.intensity * falloff(scene, punctual, towards, distance), towards,
          both::reach_of_shadow_ray(distance, punctual.position)};
}

/// The light that comes from the centre of a punctual light, not yet divided by a chance.
LightSample light_of(const scene::Scene& scene, const scene::PunctualLight& punctual,
                     Vec3 position) {
  switch (punctual.kind) {
    case scene::LightKind::directional:
      return {punctual.intensity, -punctual.direction, INFINITY};
    case scene::LightKind::point:
    case scene::LightKind::spot:
      return light_from_point(scene, punctual, position);
  }
  return {};
}

/// A disc of uniform radiance that brings E to a facing surface has L = E / (pi sin^2 a), and
/// directions uniform in its cone have density 1 / (2 pi (1 - cos a)): one of them stands for
/// L 2 pi (1 - cos a) = E 2 / (1 + cos a).
void spread_over_disc(const scene::PunctualLight& sun, RandomStream& random, LightSample& sample) {
  const float half_sine = std::sin(0.5f * sun.angular_radius_rad);
  const float height = 2 * half_sine * half_sine;  // 1 - cos a without cancellation
  const Vec2 u = random.next2();
  const float down = u.y * height, radius = std::sqrt(std::max(0.0f, down * (2 - down)));
  const float phi = 2 * kPi * u.x;
  const Frame frame = frame_around(sample.towards);
  sample.towards =
      normalize(frame.to_world({radius * std::cos(phi), radius * std::sin(phi), 1 - down}));
  sample.irradiance *= 2 / (2 - height);
}

}  // namespace

Emitters collect_emitters(const scene::Scene& scene, const Surfaces& surfaces) {
  // All triangles of emissive materials.
  std::vector<Emitter> candidates;
  for (uint32_t i = 0; i < scene.instances.size(); ++i) {
    const scene::Mesh& mesh = scene.meshes[scene.instances[i].mesh];
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      const scene::Material& material = scene.materials[mesh.triangle_material[t]];
      if (max_component(material.emission) > 0)
        candidates.push_back({scene::world_triangle(scene, i, t),
                              surfaces.front[surfaces.number(i, t)], i, t, 0,
                              material.double_sided});
    }
  }
  // Their powers, with what textures make of them.
  std::vector<double> power(candidates.size());
  parallel_for(candidates.size(), 256, [&](size_t begin, size_t end) {
    for (size_t k = begin; k < end; ++k) power[k] = power_of(scene, candidates[k]);
  });
  const double total = std::accumulate(power.begin(), power.end(), 0.0);
  // The chance of each, its sum, and its density on the area for rays that find it by themselves.
  Emitters out;
  out.pdf_area.resize(surfaces.first_triangle.back());
  out.chance_below.push_back(0);
  for (size_t k = 0; k < candidates.size(); ++k) {
    if (!(power[k] > 0)) continue;
    Emitter& e = out.triangles.emplace_back(candidates[k]);
    const double chance = power[k] / total;
    e.pdf_area = float(chance / double(scene::area_m2(e.corners)));
    out.pdf_area[surfaces.number(e.instance, e.triangle)] = e.pdf_area;
    out.chance_below.push_back(out.chance_below.back() + chance);
  }
  return out;
}

EmitterPoint sample_emitters(const Emitters& emitters, RandomStream& random) {
  const Emitter& e = emitters.triangles[pick(emitters.chance_below, fine_number(random))];
  return point_on(e, random.next2());
}

EmitterPoint emitter_point(const Emitters& emitters, double x, double y) {
  const std::vector<double>& below = emitters.chance_below;
  const size_t k = pick(below, x);
  const double left = (x * below.back() - below[k]) / (below[k + 1] - below[k]);
  return point_on(emitters.triangles[k], {below_one(left), below_one(y)});
}

SkySampler sky_sampler(const scene::Environment& map) {
  SkySampler out;
  if (map.empty()) return out;
  const size_t width = size_t(map.width);
  out.row_below.push_back(0);
  for (int y = 0; y < map.height; ++y) {
    double sum = 0;
    out.column_below.push_back(0);
    for (size_t x = 0; x < width; ++x) {
      sum += double(luminance(map.radiance[size_t(y) * width + x]));
      out.column_below.push_back(sum);
    }
    out.row_below.push_back(out.row_below.back() + sum * scene::pixel_solid_angle(map, y));
  }
  return out;
}

SkyPoint sample_sky(const scene::Environment& map, const SkySampler& sampler,
                    RandomStream& random) {
  const size_t row = pick(sampler.row_below, fine_number(random));
  const auto columns =
      std::span(sampler.column_below).subspan(row * size_t(map.width + 1), size_t(map.width + 1));
  const size_t column = pick(columns, fine_number(random));
  const Vec2 u = random.next2();
  // Uniform in azimuth and in the cosine of the polar angle.
  const double from = std::cos(kPiDouble * double(row) / map.height);
  const double to = std::cos(kPiDouble * double(row + 1) / map.height);
  const double theta = std::acos(from + (to - from) * double(u.y));
  const Vec3 d = scene::direction_of(
      map, {(float(column) + u.x) / float(map.width), float(theta / kPiDouble)});
  return {d, sky_pdf(map, sampler, d)};
}

float sky_pdf(const scene::Environment& map, const SkySampler& sampler, Vec3 direction) {
  if (!(sampler.power() > 0)) return 0;
  return float(double(luminance(scene::radiance_towards(map, direction))) / sampler.power());
}

LightSample sample_punctual_lights(const scene::Scene& scene, const Receiver& at,
                                   RandomStream& random, std::vector<float>& scratch) {
  const size_t count = scene.lights.size();
  scratch.resize(count);
  float total = 0;
  for (size_t k = 0; k < count; ++k) {
    const scene::PunctualLight& punctual = scene.lights[k];
    const LightSample light = light_of(scene, punctual, at.position);
    // A disc reaches over the horizon when its centre is still below it.
    const float reach = scene::has_disc(punctual) ? std::sin(punctual.angular_radius_rad) : 0.0f;
    const float cosine = std::max(0.0f, dot(light.towards, at.normal) + reach);
    scratch[k] = luminance(light.irradiance) * cosine;
    total += scratch[k];
  }
  if (!(total > 0)) return {};
  float left = random.next() * total;
  size_t k = 0;
  // Rounding may leave a remainder after the last light: the last one that brings light takes it.
  for (size_t next = 0; next < count; ++next) {
    if (scratch[next] <= 0) continue;
    k = next;
    if (left < scratch[next]) break;
    left -= scratch[next];
  }
  LightSample sample = light_of(scene, scene.lights[k], at.position);
  sample.irradiance *= total / scratch[k];
  if (scene::has_disc(scene.lights[k])) spread_over_disc(scene.lights[k], random, sample);
  return sample;
}

}  // namespace luxel::reference
