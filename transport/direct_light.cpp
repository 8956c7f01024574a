#include "transport/direct_light.h"

#include <algorithm>
#include <atomic>

#include "base/check.h"
#include "base/parallel.h"
#include "base/random.h"
#include "base/warp.h"
#include "transport/light_cut.h"
#include "transport/spherical_triangle.h"

namespace luxel::transport {
namespace {

constexpr size_t kMaxCut = 32;
constexpr size_t kMaxPunctual = 64;
/// Below it a triangle is so small that sampling its area is as good, and more exact in floats.
constexpr float kMinSolidAngle = 1e-3f;

struct Receiver {
  Vec3 position, normal, geometric_normal;
  Vec3 origin;  ///< position moved off the surface: where shadow rays start
  uint64_t seed = 0;
};

/// A shadow ray and what its source would bring.
struct Shot {
  uint32_t source = 0;  ///< index into Work::sources
  float weight = 0;     ///< w: what the source's density does not cancel
  Rgb radiance;         ///< times w
};

/// The visible share of a source is  sum w V / sum w  over its shots; its light is that share times
/// the exact unshadowed light. A group of lights has no exact value: its light is the mean of w V.
struct Source {
  float scale = 0;  ///< exact: irradiance per radiance / chance; group: 1 / (shots * chance)
  bool exact = false;
  float sum_weight = 0;
  uint32_t shots = 0;
  Rgb sum{};
  float sum_luminance2 = 0;
  Rgb tint{1, 1, 1};     ///< multiplies the sum
  float unshadowed = 0;  ///< luminance, for the variance of exact sources
};

/// Buffers of one worker, reused from element to element.
struct Work {
  std::vector<CutEntry> cut;
  std::vector<Source> sources;
  std::vector<Shot> shots;
  std::vector<trace::Ray> rays;
  std::vector<uint8_t> blocked;
  std::vector<Rgb> arriving;  ///< share of each shot's light
};

/// Adds a shot whose shadow ray ends at `target`, or, with t_max infinite, goes on for ever. A
/// direction below the receiver's own triangle is blocked by it: it counts, without a ray.
void add_shot(Work& work, const Receiver& at, const Shot& shot, Vec3 direction, float t_max) {
  Source& source = work.sources[shot.source];
  source.sum_weight += shot.weight;
  ++source.shots;
  if (dot(direction, at.geometric_normal) <= 0) return;
  work.shots.push_back(shot);
  work.rays.push_back({at.origin, 0, direction, t_max});
}

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
              uint32_t source, float factor, const Receiver& r, float diagonal_m, Work& work) {
  const bool front = dot(r.position - light.a, light.normal) > 0;
  // The ray ends just before the light, so that the light itself does not block it, nor a wall that
  // touches the light when the point lies on their common edge.
  constexpr float kEnd = 1 - 1e-4f;
  const Vec3 end =
      trace::offset_origin(point.target, front ? light.normal : -light.normal, diagonal_m);
  const Rgb radiance = light.textured ? radiance_at(scene, light, point.at) : light.mean_radiance;
  const float w = point.weight * factor;
  add_shot(work, r, {source, w, radiance * w}, end - r.origin, kEnd);
}

/// Shots at one triangle. Points below the receiver's horizon bring nothing and would starve the
/// ratio: the sequence is followed until `count` points lie above it.
void shoot_at_triangle(const scene::Scene& scene, const TriangleLight& light, uint32_t source,
                       uint32_t count, const Receiver& r, float diagonal_m, Work& work) {
  const auto spherical = spherical_triangle(r.position, light.a, light.b, light.c);
  const bool by_angle = spherical.solid_angle > kMinSolidAngle;
  const uint64_t seed = hash64(r.seed, (uint64_t(light.instance) << 32) | light.triangle);
  uint32_t kept = 0;
  for (uint32_t k = 0; kept < count && k < 8 * count + 64; ++k) {
    const Vec2 u = sobol_owen_2d(k, seed);
    const LightPoint point =
        by_angle ? sample_solid_angle(light, spherical, r, u) : sample_area(light, r, u);
    if (point.weight <= 0) continue;
    shoot_at(scene, light, point, source, 1, r, diagonal_m, work);
    ++kept;
  }
}

/// Shots at a group: a triangle in proportion to its power, a point on it by area.
void shoot_at_group(const scene::Scene& scene, const Lights& lights, const LightNode& node,
                    uint32_t source, uint32_t count, const Receiver& r, float diagonal_m,
                    Work& work) {
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
      shoot_at(scene, light, point, source, point.measure / chance, r, diagonal_m, work);
  }
}

/// Shares `samples` shots out over the cut in proportion to importance, at least one to each entry
/// while there are twice as many shots as entries. Where there are fewer, an entry that deserves
/// less than one gets one with that chance (systematic sampling), and counts for more then.
void shoot_at_triangles(const scene::Scene& scene, const Lights& lights, int samples,
                        const Receiver& r, float diagonal_m, Work& work) {
  light_cut(lights, r.position, r.normal, kMaxCut, work.cut);
  float total = 0;
  for (const CutEntry& entry : work.cut) total += entry.importance;
  if (!(total > 0)) return;
  RandomStream random{hash64(r.seed, 0x11)};
  float owed = random.next();
  const float least = size_t(samples) >= 2 * work.cut.size() ? 1.0f : 0.0f;
  for (const CutEntry& entry : work.cut) {
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
    const uint32_t source = uint32_t(work.sources.size());
    Source s;
    s.exact = entry.exact;
    s.scale = entry.exact ? entry.irradiance_per_radiance / chance : 1 / (float(count) * chance);
    s.unshadowed = entry.importance / chance;
    work.sources.push_back(s);
    if (entry.exact)
      shoot_at_triangle(scene, lights.triangles[node.first], source, count, r, diagonal_m, work);
    else
      shoot_at_group(scene, lights, node, source, count, r, diagonal_m, work);
  }
}

/// A directional light whose disc has some size: directions uniform in its cone.
void shoot_at_disc(const scene::PunctualLight& light, uint32_t source, int samples,
                   const Receiver& r, Work& work) {
  const Frame frame = frame_around(-light.direction);
  // 1 - cos(angle) without cancellation.
  const float s = std::sin(0.5f * light.angular_radius_rad);
  const float height = 2 * s * s;
  for (int k = 0; k < samples; ++k) {
    const Vec2 u = sobol_owen_2d(uint32_t(k), hash64(r.seed, 0x5000 + source));
    const float down = u.y * height, radius = std::sqrt(std::max(0.0f, down * (2 - down)));
    const float phi = 2 * kPi * u.x;
    const Vec3 d = frame.to_world({radius * std::cos(phi), radius * std::sin(phi), 1 - down});
    const float w = std::max(0.0f, dot(d, r.normal));
    if (w > 0) add_shot(work, r, {source, w, Rgb{1, 1, 1} * w}, d, INFINITY);
  }
}

void shoot_at_punctual(const Lights& lights, size_t index, float chance, int samples,
                       const Receiver& r, Work& work) {
  const scene::PunctualLight& light = lights.punctual[index];
  const PunctualIncidence in = incidence_at(light, lights.profiles, r.position);
  const float cosine = dot(in.towards, r.normal);
  const bool disc =
      light.kind == scene::PunctualLight::Kind::directional && light.angular_radius_rad > 0;
  if (max_component(in.irradiance) <= 0 || (cosine <= 0 && !disc)) return;
  const uint32_t source = uint32_t(work.sources.size());
  work.sources.push_back({});
  Source& s = work.sources.back();
  s.exact = true;
  if (disc)
    shoot_at_disc(light, source, samples, r, work);
  else
    add_shot(work, r, {source, 1, {1, 1, 1}}, in.towards,
             std::isfinite(in.distance_m) ? in.distance_m * (1 - 1e-5f) : INFINITY);
  // Over the disc the cosine averages to that of its centre while all of it is above the horizon.
  const float seen = disc ? work.sources[source].sum_weight / float(samples) : cosine;
  const bool whole = disc && work.sources[source].shots == uint32_t(samples);
  work.sources[source].scale = (whole ? std::max(cosine, 0.0f) : seen) / chance;
  work.sources[source].unshadowed = luminance(in.irradiance) * work.sources[source].scale;
  work.sources[source].tint = in.irradiance;
}

void shoot_at_lamps(const Lights& lights, int samples, const Receiver& r, Work& work) {
  const size_t count = lights.punctual.size();
  if (count <= kMaxPunctual) {
    for (size_t i = 0; i < count; ++i) shoot_at_punctual(lights, i, 1, samples, r, work);
    return;
  }
  // Many lamps: systematic sampling in proportion to unshadowed light.
  std::vector<float> importance(count);
  float total = 0;
  for (size_t i = 0; i < count; ++i) {
    const auto in = incidence_at(lights.punctual[i], lights.profiles, r.position);
    importance[i] = luminance(in.irradiance) * std::max(0.0f, dot(in.towards, r.normal));
    total += importance[i];
  }
  if (!(total > 0)) return;
  RandomStream random{hash64(r.seed, 0x12)};
  float owed = random.next();
  for (size_t i = 0; i < count; ++i) {
    const float chance = std::min(1.0f, float(kMaxPunctual) * importance[i] / total);
    owed += chance;
    if (owed < 1) continue;
    owed -= 1;
    shoot_at_punctual(lights, i, chance, samples, r, work);
  }
}

/// Peaks of the environment, in proportion to their power. Blocked like everything else that is far
/// away; the mean of w V, for nothing is known exactly but the density.
void shoot_at_peaks(const scene::Scene& scene, const Surroundings& around, int samples,
                    const Receiver& r, Work& work) {
  if (around.peak.empty()) return;
  const uint32_t source = uint32_t(work.sources.size());
  work.sources.push_back({.scale = 1 / float(samples)});
  for (int k = 0; k < samples; ++k) {
    const PeakSample peak =
        sample_peaks(scene, around, sobol_owen_2d(uint32_t(k), hash64(r.seed, 0x13)));
    const float w = folded_cosine(peak.direction, r.normal, r.geometric_normal);
    add_shot(work, r, {source, w, peak.radiance_over_pdf * w}, peak.direction, INFINITY);
  }
}

/// The soft light of the surroundings, by rays with the density of the cosine.
void shoot_at_soft_sky(const scene::Scene& scene, const Surroundings& around, int samples,
                       const Receiver& r, Work& work) {
  if (samples == 0 || (around.limit == INFINITY && max_component(around.background) <= 0)) return;
  const uint32_t source = uint32_t(work.sources.size());
  work.sources.push_back({.scale = kPi / float(samples)});
  const Frame frame = frame_around(r.normal);
  for (int k = 0; k < samples; ++k) {
    const Vec2 u = sobol_owen_2d(uint32_t(k), hash64(r.seed, 0x14));
    Vec3 d = frame.to_world(cosine_hemisphere_sample(u));
    const float above = dot(d, r.geometric_normal);
    if (above < 0) d += r.geometric_normal * (-2 * above);
    add_shot(work, r, {source, 1, soft_radiance(scene, around, d)}, d, INFINITY);
  }
}

void trace_shots(const trace::RayTracer& tracer, Work& work) {
  work.arriving.resize(work.rays.size());
  if (tracer.has_tints()) return tracer.transmitted(work.rays, work.arriving);
  work.blocked.resize(work.rays.size());
  tracer.occluded(work.rays, work.blocked);
  for (size_t k = 0; k < work.rays.size(); ++k)
    work.arriving[k] = work.blocked[k] ? Rgb{} : Rgb{1, 1, 1};
}

/// Traces the shots and adds the sources up.
void resolve(const trace::RayTracer& tracer, Work& work, Rgb& irradiance, float& variance) {
  trace_shots(tracer, work);
  for (size_t k = 0; k < work.shots.size(); ++k) {
    if (max_component(work.arriving[k]) <= 0) continue;
    const Shot& shot = work.shots[k];
    Source& source = work.sources[shot.source];
    const Rgb arrived = shot.radiance * work.arriving[k];
    source.sum += arrived;
    const float l = luminance(arrived);
    source.sum_luminance2 += l * l;
  }
  for (const Source& s : work.sources) {
    if (s.shots == 0 || s.sum_weight <= 0) continue;
    const float n = float(s.shots);
    const Rgb light = s.sum * s.tint * (s.exact ? s.scale / s.sum_weight : s.scale);
    irradiance += light;
    if (s.exact) {
      const float share = std::min(1.0f, luminance(light) / std::max(s.unshadowed, 1e-30f));
      variance += s.unshadowed * s.unshadowed * share * (1 - share) / n;
    } else {
      const float mean = luminance(s.sum) / n, mean2 = s.sum_luminance2 / n;
      variance += std::max(0.0f, mean2 - mean * mean) * s.scale * s.scale * n;
    }
  }
}

}  // namespace

Result<DirectLight> direct_light(const scene::Scene& scene, const Elements& elements,
                                 const Lights& lights, const trace::RayTracer& tracer,
                                 const DirectParams& params, Progress& progress) {
  LUXEL_CHECK(params.samples >= 1);
  DirectLight out;
  out.irradiance.resize(elements.size());
  out.variance.resize(elements.size());
  const float diagonal_m = scene::world_bounds(scene).diagonal();
  std::atomic<uint64_t> rays{0};
  progress.begin("direct light", elements.size());
  parallel_for(elements.size(), 256, [&](size_t begin, size_t end) {
    if (progress.cancelled()) return;
    Work work;
    uint64_t traced = 0;
    for (size_t i = begin; i < end; ++i) {
      work.sources.clear(), work.shots.clear(), work.rays.clear();
      const Receiver r{
          elements.position[i], elements.normal[i], elements.geometric_normal[i],
          trace::offset_origin(elements.position[i], elements.geometric_normal[i], diagonal_m),
          hash64(params.seed, params.same_points ? 0 : i)};
      shoot_at_triangles(scene, lights, params.samples, r, diagonal_m, work);
      shoot_at_lamps(lights, params.samples, r, work);
      shoot_at_peaks(scene, lights.around, params.samples, r, work);
      shoot_at_soft_sky(scene, lights.around, params.sky_samples, r, work);
      resolve(tracer, work, out.irradiance[i], out.variance[i]);
      traced += work.rays.size();
    }
    rays += traced;
    progress.advance(end - begin);
  });
  if (progress.cancelled()) return fail(ErrorCode::cancelled, "stopped by the user");
  out.rays = rays;
  return out;
}

}  // namespace luxel::transport
