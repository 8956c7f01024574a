#include "luxel/reference/paths.h"

#include <cmath>

#include "luxel/base/warp.h"
#include "luxel/light/surroundings.h"
#include "luxel/scene/sides.h"

namespace luxel::reference {
namespace {

/// Paths of fewer reflections than this are never ended by chance.
constexpr int kSureBounces = 8;
/// A ray towards a point of an emitter ends there, unless it met something before this part of it.
constexpr float kArrived = 1 - 1e-5f, kBeyond = 1 + 1e-4f;

/// The cosine with which light from `d` is gathered that surfaces have reflected, or the sky.
float folded_cosine(const Receiver& at, Vec3 d) {
  return light::folded_cosine(d, at.normal, at.geometric_normal);
}

/// The power heuristic with exponent 2 [Veach95] for a sample of density `own` that the other
/// strategy would have found with density `other`.
float mis_weight(float own, float other) {
  const float ratio = other / own;
  return 1 / (1 + ratio * ratio);
}

trace::Ray random_ray(Path& path) {
  const DVec2 u = point_in(next_cell(path.cells), path.random.next2());
  const Vec3 local = cosine_hemisphere_sample({float(u.x), float(u.y)});
  const Vec3 d = frame_around(path.at.normal).to_world(local);
  return {path.at.position, 0, light::mirrored_above(d, path.at.geometric_normal), INFINITY};
}

EmitterPoint pick_point(const Emitters& emitters, Path& path) {
  const Cell cell = next_cell(path.cells);
  if (cell.count == 0) return sample_emitters(emitters, path.random);
  const DVec2 u = point_in(cell, path.random.next2());
  return emitter_point(emitters, u.x, u.y);
}

/// Next-event estimation: one point of the emissive triangles, weighted against the chance that
/// random_ray finds it.
void aim_at_emitter(const TracedScene& world, Path& path, uint32_t index, PathBuffers& work) {
  const EmitterPoint point = pick_point(world.emitters, path);
  const Emitter& e = *point.emitter;
  const Vec3 to_light = point.position - path.at.position;
  const float d2 = dot(to_light, to_light);
  if (!(d2 > 0)) return;
  const Vec3 d = to_light / std::sqrt(d2);
  float light_cosine = -dot(d, e.front);
  if (e.two_sided) light_cosine = std::abs(light_cosine);
  const float cosine = dot(d, path.at.normal);
  if (light_cosine <= 0 || cosine <= 0 || dot(d, path.at.geometric_normal) <= 0) return;
  const float coverage =
      scene::passage_at(world.scene, {e.instance, e.triangle, point.at}).coverage;
  if (coverage <= 0) return;
  const float pdf = e.pdf_area * d2 / light_cosine;  // per steradian
  const float weight = mis_weight(pdf, folded_cosine(path.at, d) / kPi);
  work.emitter_rays.push_back(
      {index, point, path.throughput * (coverage * cosine / kPi * weight / pdf)});
  work.rays.push_back({path.at.position, 0, to_light, kBeyond});
}

void aim_at_punctual_light(const TracedScene& world, Path& path, uint32_t index,
                           PathBuffers& work) {
  const LightSample punctual =
      sample_punctual_lights(world.scene, path.at, path.random, work.punctual_weights);
  const float cosine = dot(punctual.towards, path.at.normal);
  if (max_component(punctual.irradiance) <= 0 || cosine <= 0) return;
  if (dot(punctual.towards, path.at.geometric_normal) <= 0) return;
  work.along_shadow_rays.push_back({index, path.throughput * punctual.irradiance * (cosine / kPi)});
  work.shadow_rays.push_back({path.at.position, 0, punctual.towards, punctual.reach_m});
}

/// One direction of the environment, weighted against the chance that random_ray finds it.
void aim_at_sky(const TracedScene& world, Path& path, uint32_t index, PathBuffers& work) {
  const SkyPoint sky = sample_sky(world.scene.environment, world.sky, path.random);
  if (!(sky.pdf > 0) || dot(sky.direction, path.at.geometric_normal) <= 0) return;
  const float cosine = folded_cosine(path.at, sky.direction);
  const float weight = mis_weight(sky.pdf, cosine / kPi);
  const Rgb light = scene::radiance_towards(world.scene.environment, sky.direction);
  work.along_shadow_rays.push_back(
      {index, path.throughput * light * (cosine / kPi * weight / sky.pdf)});
  work.shadow_rays.push_back({path.at.position, 0, sky.direction, INFINITY});
}

/// Adds the sky's light along a random ray that has left the scene.
void add_found_sky(const TracedScene& world, Vec3 d, Path& path) {
  Rgb light = world.scene.background;
  if (world.sky.power() > 0) {
    const float pdf = sky_pdf(world.scene.environment, world.sky, d);
    light += scene::radiance_towards(world.scene.environment, d) *
             mis_weight(folded_cosine(path.at, d) / kPi, pdf);
  }
  path.value += path.throughput * light;
}

void add_emitter_light(const TracedScene& world, const EmitterRay& ray, const trace::Hit& hit,
                       Rgb tint, std::span<Path> paths) {
  const Emitter& e = *ray.point.emitter;
  const bool same = hit.instance == e.instance && hit.triangle == e.triangle;
  if (hit.found() && !same && hit.t < kArrived) return;
  paths[ray.path].value +=
      ray.factor * tint * scene::emission_at(world.scene, {e.instance, e.triangle, ray.point.at});
}

/// All rays of a bounce. Where nothing colours light, tints are 1.
void trace(const TracedScene& world, PathBuffers& work) {
  work.hits.resize(work.rays.size());
  world.tracer.closest_hits(work.rays, work.hits);
  work.tint.assign(work.rays.size(), {1, 1, 1});
  work.arriving.resize(work.shadow_rays.size());
  if (world.tracer.has_tints()) world.tracer.tint(work.rays, work.hits, work.tint);
  world.tracer.transmitted(work.shadow_rays, work.arriving);
}

/// Emission that a random ray has found, weighted against the chance that aim_at_emitter picks the
/// same point. Emitted light counts with the plain cosine, while the ray's density is that of the
/// folded one.
void add_found_emission(const TracedScene& world, const trace::Hit& hit, Vec3 d, Path& path) {
  const Rgb emission = scene::emission_at(world.scene, hit.point());
  const float cosine = dot(d, path.at.normal);
  if (max_component(emission) <= 0 || cosine <= 0) return;
  const uint32_t number = world.surfaces.number(hit.instance, hit.triangle);
  const float folded = folded_cosine(path.at, d);
  const float pdf_area = world.emitters.pdf_area[number];
  const float light_cosine = std::abs(dot(d, world.surfaces.front[number]));
  if (pdf_area > 0 && light_cosine <= 0) return;
  const float weight =
      pdf_area > 0 ? mis_weight(folded / kPi, pdf_area * hit.t * hit.t / light_cosine) : 1.0f;
  path.value += path.throughput * emission * (cosine / folded * weight);
}

/// Russian roulette: a path that carries little ends, or goes on for those that did.
bool survives(Path& path, int reflections) {
  const float carried = luminance(path.throughput);
  if (!(carried > 0)) return false;
  if (reflections <= kSureBounces || carried >= 1) return true;
  if (path.random.next() >= carried) return false;
  path.throughput = path.throughput / carried;
  return true;
}

/// Multiplies by the reflectance, or, by chance, by the transmittance: then the path goes on to the
/// light of the other side. Returns the side whose light is asked for next.
trace::Hit send_on(const TracedScene& world, const trace::Hit& hit, Path& path) {
  const Rgb rho = scene::reflectance_at(world.scene, hit.point());
  const Rgb tau = scene::diffuse_transmittance_at(world.scene, hit.point());
  const float sum = luminance(rho) + luminance(tau);
  const float through = sum > 0 ? luminance(tau) / sum : 0.0f;
  if (!(through > 0)) {
    path.throughput = path.throughput * rho;
    return hit;
  }
  if (path.random.next() >= through) {
    path.throughput = path.throughput * rho / (1 - through);
    return hit;
  }
  path.throughput = path.throughput * tau / through;
  trace::Hit other = hit;
  if (const auto p = scene::other_side_of(world.scene, hit.point()))
    other.triangle = p->triangle, other.at = p->at;
  else
    other.back_face = !hit.back_face;
  return other;
}

/// Takes the light that the path's ray has found and moves the path there. False when it ends.
bool advance(const TracedScene& world, const trace::Ray& ray, const trace::Hit& hit, int depth,
             int bounces, Path& path) {
  if (!hit.found()) {
    add_found_sky(world, ray.direction, path);
    return false;
  }
  if (hit.back_face) {
    const scene::Material& material = scene::material_at(world.scene, hit.point());
    const bool two_sided = scene::reflects_from_behind(material);
    if (depth == 0) path.first_hit = two_sided ? FirstHit::double_sided_back : FirstHit::back;
    if (!two_sided) return false;
  }
  if (!hit.back_face || scene::material_at(world.scene, hit.point()).double_sided)
    add_found_emission(world, hit, ray.direction, path);
  if (depth == bounces) return false;
  const trace::Hit side = send_on(world, hit, path);
  if (!survives(path, depth + 1)) return false;
  path.at = receiver_at(world.scene, world.surfaces, side);
  return true;
}

}  // namespace

TracedScene traced_scene(const scene::Scene& scene, const trace::RayTracer& tracer) {
  Surfaces surfaces = surfaces_of(scene);
  Emitters emitters = collect_emitters(scene, surfaces);
  return {scene, tracer, std::move(surfaces), std::move(emitters), sky_sampler(scene.environment)};
}

namespace {

/// A place of number i in an order of `count`, one of many: [Kensler13, section 4].
uint32_t place_in_order(uint32_t i, uint32_t count, uint32_t order) {
  uint32_t w = count - 1;
  for (const int shift : {1, 2, 4, 8, 16}) w |= w >> shift;
  do {
    i ^= order, i *= 0xe170893du, i ^= order >> 16;
    i ^= (i & w) >> 4, i ^= order >> 8;
    i *= 0x0929eb3fu, i ^= order >> 23;
    i ^= (i & w) >> 1, i *= 1 | order >> 27;
    i *= 0x6935fa69u, i ^= (i & w) >> 11;
    i *= 0x74dcb303u, i ^= (i & w) >> 2;
    i *= 0x9e501cc3u, i ^= (i & w) >> 2;
    i *= 0xc860a3dfu, i &= w;
    i ^= i >> 5;
  } while (i >= count);
  return (i + order) % count;
}

}  // namespace

Cell next_cell(Cells& cells) {
  if (cells.first.count == 0) return {};
  const uint64_t order = hash64(cells.seed, cells.drawn++);
  return {place_in_order(cells.first.number, cells.first.count, uint32_t(order)),
          cells.first.count};
}

DVec2 point_in(Cell cell, Vec2 u) {
  if (cell.count == 0) return {double(u.x), double(u.y)};
  const auto n = uint64_t(cell.count), columns = uint64_t(std::sqrt(double(n)));
  const uint64_t column = cell.number * columns / n;
  const uint64_t first = (column * n + columns - 1) / columns;
  const uint64_t next = ((column + 1) * n + columns - 1) / columns;
  const auto in_column = double(next - first);
  return {(double(first) + in_column * double(u.x)) / double(n),
          (double(cell.number - first) + double(u.y)) / in_column};
}

Path path_from(const Receiver& at, RandomStream random) {
  Path path;
  path.at = at;
  path.random = random;
  return path;
}

Path path_from_eye(const TracedScene& world, Vec3 direction, const trace::Hit& hit,
                   RandomStream random) {
  if (!hit.found()) {
    Path path;
    path.throughput = {};
    path.value = scene::smooth_surroundings_towards(world.scene, direction);
    return path;
  }
  Path path;
  path.random = random;
  if (scene::material_at(world.scene, hit.point()).unlit) {
    const auto color = scene::base_color_at(world.scene, hit.point());
    path.throughput = {};
    path.value = {color[0], color[1], color[2]};
    path.shows_surface = true;
    return path;
  }
  path.at = receiver_at(world.scene, world.surfaces, send_on(world, hit, path));
  path.value = scene::emission_at(world.scene, hit.point());
  path.shows_surface = true;
  return path;
}

uint64_t follow(const TracedScene& world, int bounces, std::span<Path> paths, PathBuffers& work) {
  uint64_t rays = 0;
  work.active.clear();
  for (uint32_t i = 0; i < paths.size(); ++i)
    if (max_component(paths[i].throughput) > 0) work.active.push_back(i);
  for (int depth = 0; !work.active.empty(); ++depth) {
    work.rays.clear(), work.emitter_rays.clear();
    work.shadow_rays.clear(), work.along_shadow_rays.clear();
    // A random ray of each path, then its rays towards lights: hits and tints are in this order.
    for (const uint32_t i : work.active) work.rays.push_back(random_ray(paths[i]));
    for (const uint32_t i : work.active) {
      if (!world.emitters.triangles.empty()) aim_at_emitter(world, paths[i], i, work);
      if (!world.scene.lights.empty()) aim_at_punctual_light(world, paths[i], i, work);
      if (world.sky.power() > 0) aim_at_sky(world, paths[i], i, work);
    }
    // Trace them all, and take the light that arrives along the rays towards lights.
    trace(world, work);
    rays += work.rays.size() + work.shadow_rays.size();
    const size_t count = work.active.size();
    for (size_t k = 0; k < work.emitter_rays.size(); ++k)
      add_emitter_light(world, work.emitter_rays[k], work.hits[count + k], work.tint[count + k],
                        paths);
    for (size_t k = 0; k < work.along_shadow_rays.size(); ++k)
      paths[work.along_shadow_rays[k].path].value +=
          work.along_shadow_rays[k].light * work.arriving[k];
    // Move each path to where its random ray has hit, until it leaves the scene or is absorbed.
    work.next.clear();
    for (size_t k = 0; k < count; ++k) {
      const uint32_t i = work.active[k];
      paths[i].throughput = paths[i].throughput * work.tint[k];
      if (advance(world, work.rays[k], work.hits[k], depth, bounces, paths[i]))
        work.next.push_back(i);
    }
    work.active.swap(work.next);
  }
  return rays;
}

}  // namespace luxel::reference
