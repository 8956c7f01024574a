// The estimator of luxel/reference/paths.h: a thread follows paths of one receiver or pixel one after
// the other, with the random numbers that they have on the processor.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "luxel/trace/vulkan/shaders/hierarchy.glsl"
#include "luxel/scene/both_environment.h"
#include "luxel/base/both_triangle.h"
#include "world_of_paths.glsl"
#include "camera.glsl"
layout(local_size_x = kPathThreads) in;

// A point at which receivers ask for light.
IN_BUFFER(Places, Place);
IN_BUFFER(Hits, Hit);

#include "luxel/reference/device/path_push_shared.h"

// Paths of fewer reflections than this are never ended by chance.
const int kSureBounces = 8;
// A ray towards a point of an emitter ends there, unless it met something before this part of it.
const float kArrived = 1 - 1e-5, kBeyond = 1 + 1e-4;

struct Path {
  Place at;
  vec3 throughput, value;
  Random random;
};

float folded(Path path, vec3 d) { return folded_cosine(d, path.at.normal, path.at.geometric_normal); }

// The power heuristic [Veach95].
float mis_weight(float own, float other) {
  float ratio = other / own;
  return 1 / (1 + ratio * ratio);
}

// The part of the chances that u falls into: the first of `count` that ends beyond u * all, in a list
// that begins at `from`.
uint pick(Doubles below, uint from, uint count, double u) {
  double at = u * below.at[from + count];
  uint low = 0, high = count - 1;
  while (low < high) {
    uint middle = (low + high) / 2;
    if (below.at[from + middle + 1] > at)
      high = middle;
    else
      low = middle + 1;
  }
  return low;
}

vec3 sky_towards(vec3 d) {
  return setup.pixels.at[pixel_of_environment(setup.map_width, setup.map_height,
                                              place_in_environment(setup.rotation_rad, d))];
}
// Between pixels, for those who look at the sky: scene::smooth_radiance_towards().
vec3 smooth_sky_towards(vec3 d) {
  vec2 place = place_in_environment(setup.rotation_rad, d);
  float x = place.x * float(setup.map_width) - 0.5,
        y = clamp(place.y * float(setup.map_height) - 0.5, 0.0, float(setup.map_height - 1));
  int x0 = int(floor(x)), y0 = int(y), y1 = min(y0 + 1, setup.map_height - 1);
  int left = x0 < 0 ? setup.map_width - 1 : x0, right = x0 + 1 < setup.map_width ? x0 + 1 : 0;
  float fx = x - float(x0), fy = y - float(y0);
  vec3 upper = mix(setup.pixels.at[y0 * setup.map_width + left], setup.pixels.at[y0 * setup.map_width + right], fx),
       lower = mix(setup.pixels.at[y1 * setup.map_width + left], setup.pixels.at[y1 * setup.map_width + right], fx);
  return mix(upper, lower, fy);
}
float sky_power() { return setup.map_width == 0 ? 0.0 : float(setup.row_below.at[setup.map_height]); }
float sky_pdf(vec3 d) { return float(double(luminance(sky_towards(d))) / setup.row_below.at[setup.map_height]); }

// scene::direction_of()
vec3 direction_of(vec2 place) {
  float azimuth = (place.x - 0.5) * 2 * kPi + setup.rotation_rad;
  vec2 polar = cos_and_sin(place.y * kPi);
  float turns = azimuth / (2 * kPi);
  vec2 around = unit_circle(min(turns - floor(turns), 0.99999994));
  return vec3(polar.y * around.x, polar.x, polar.y * around.y);
}

// A ray of the path and what it is for.
struct Aim {
  Ray ray;
  vec3 factor;  // of the light that arrives
  uint emitter;  // the triangle that it is aimed at
  vec2 at;       // the place on that
};

bool aim_at_emitter(inout Path path, out Aim aim) {
  uint k = pick(setup.chance_below, 0, setup.emitter_count, next_fine(path.random));
  vec2 at = point_of_triangle(next_vec2(path.random));
  uint number = setup.emitters.at[k];
  PathTriangle t = setup.triangles.at[number];
  PathMaterial m = setup.materials.at[t.material];
  vec3 to_light = between(t.corner, at) - path.at.position;
  float d2 = dot(to_light, to_light);
  if (!(d2 > 0)) return false;
  vec3 d = to_light / sqrt(d2);
  float light_cosine = -dot(d, t.front);
  if ((m.flags & kDoubleSided) != 0) light_cosine = abs(light_cosine);
  float cosine = dot(d, path.at.normal);
  if (light_cosine <= 0 || cosine <= 0 || dot(d, path.at.geometric_normal) <= 0) return false;
  float coverage = coverage_at(setup, t, m, at);
  if (coverage <= 0) return false;
  float pdf = t.pdf_area * d2 / light_cosine;
  float weight = mis_weight(pdf, folded(path, d) / kPi);
  aim = Aim(Ray(path.at.position, to_light, 0, kBeyond), path.throughput * (coverage * cosine / kPi * weight / pdf), number, at);
  return true;
}

// Irradiance on a surface that faces the light, from its centre, and how far its shadow ray goes.
vec3 arriving_from(PathLight light, vec3 position, out vec3 towards, out float reach_m) {
  reach_m = kInfinity, towards = -light.direction;
  if (light.kind == kDirectional) return light.intensity;
  vec3 to_light = light.position - position;
  float distance_m = length(to_light);
  if (!(distance_m > 0)) return vec3(0);
  towards = to_light / distance_m;
  reach_m = reach_of_shadow_ray(distance_m, light.position);
  float f = 1 / (distance_m * distance_m);
  if (light.range_m > 0) {
    float q = distance_m / light.range_m;
    f *= clamp(1 - q * q * q * q, 0.0, 1.0);
  }
  if (light.kind == kSpot) {
    float ramp = clamp((dot(-towards, light.direction) - light.outer_cosine) / light.ramp, 0.0, 1.0);
    f *= ramp * ramp;
  }
  return light.intensity * f;
}

float punctual_weight(PathLight light, Place at) {
  vec3 towards;
  float reach_m;
  vec3 e = arriving_from(light, at.position, towards, reach_m);
  return luminance(e) * max(0.0, dot(towards, at.normal) + light.reach);
}

bool aim_at_punctual_light(inout Path path, out Aim aim) {
  float total = 0;
  for (uint k = 0; k < setup.light_count; ++k) total += punctual_weight(setup.lights.at[k], path.at);
  if (!(total > 0)) return false;
  float left = next_float(path.random) * total, own = 0;
  uint picked = 0;
  for (uint k = 0; k < setup.light_count; ++k) {
    float w = punctual_weight(setup.lights.at[k], path.at);
    if (w <= 0) continue;
    picked = k, own = w;
    if (left < w) break;
    left -= w;
  }
  PathLight light = setup.lights.at[picked];
  vec3 towards;
  float reach_m;
  vec3 e = arriving_from(light, path.at.position, towards, reach_m) * (total / own);
  if (light.has_disc != 0) {
    vec2 u = next_vec2(path.random);
    float down = u.y * light.disc_height, radius = sqrt(max(0.0, down * (2 - down)));
    vec2 circle = unit_circle(u.x);
    towards = normalize(to_world(towards, vec3(radius * circle.x, radius * circle.y, 1 - down)));
    e *= 2 / (2 - light.disc_height);
  }
  float cosine = dot(towards, path.at.normal);
  if (largest(e) <= 0 || cosine <= 0 || dot(towards, path.at.geometric_normal) <= 0) return false;
  aim = Aim(Ray(path.at.position, towards, 0, reach_m), path.throughput * e * (cosine / kPi), 0, vec2(0));
  return true;
}

bool aim_at_sky(inout Path path, out Aim aim) {
  uint width = uint(setup.map_width);
  uint row = pick(setup.row_below, 0, uint(setup.map_height), next_fine(path.random));
  uint column = pick(setup.column_below, row * (width + 1), width, next_fine(path.random));
  vec2 u = next_vec2(path.random);
  // Uniform in azimuth and in the cosine of the polar angle.
  float from = cos_and_sin(kPi * float(row) / float(setup.map_height)).x,
        to = cos_and_sin(kPi * float(row + 1) / float(setup.map_height)).x;
  float c = from + (to - from) * u.y;
  float theta = arc_tangent(sqrt(max(0.0, (1 - c) * (1 + c))), c);
  vec3 d = direction_of(vec2((float(column) + u.x) / float(width), theta / kPi));
  float pdf = sky_pdf(d);
  if (!(pdf > 0) || dot(d, path.at.geometric_normal) <= 0) return false;
  float cosine = folded(path, d), weight = mis_weight(pdf, cosine / kPi);
  aim = Aim(Ray(path.at.position, d, 0, kInfinity), path.throughput * sky_towards(d) * (cosine / kPi * weight / pdf), 0, vec2(0));
  return true;
}

// What a random ray sees that has left the scene.
void add_found_sky(inout Path path, vec3 d) {
  vec3 light = setup.background;
  if (sky_power() > 0) light += sky_towards(d) * mis_weight(folded(path, d) / kPi, sky_pdf(d));
  path.value += path.throughput * light;
}

// Emission that a random ray has found.
void add_found_emission(inout Path path, PathTriangle t, PathMaterial m, vec2 uv, vec3 d, float distance_m) {
  vec3 emission = emission_at(setup, t, m, uv);
  float cosine = dot(d, path.at.normal);
  if (largest(emission) <= 0 || cosine <= 0) return;
  float own = folded(path, d), light_cosine = abs(dot(d, t.front));
  if (t.pdf_area > 0 && light_cosine <= 0) return;
  float weight = t.pdf_area > 0 ? mis_weight(own / kPi, t.pdf_area * distance_m * distance_m / light_cosine) : 1.0;
  path.value += path.throughput * emission * (cosine / own * weight);
}

// Russian roulette.
bool survives(inout Path path, int reflections) {
  float carried = luminance(path.throughput);
  if (!(carried > 0)) return false;
  if (reflections <= kSureBounces || carried >= 1) return true;
  if (next_float(path.random) >= carried) return false;
  path.throughput /= carried;
  return true;
}

// Takes the light that the path's ray has found and moves the path there. False when it ends.
bool advance(inout Path path, vec3 d, Hit hit, int depth, inout PathSums sum) {
  if (hit.number == kNoTriangle) {
    add_found_sky(path, d);
    return false;
  }
  Side side = side_of(setup, hit);
  PathTriangle t = setup.triangles.at[side.number];
  PathMaterial m = setup.materials.at[t.material];
  if (side.back) {
    bool two_sided = (m.flags & kReflectsFromBehind) != 0;
    if (depth == 0 && two_sided) ++sum.double_sided_back;
    if (depth == 0 && !two_sided) ++sum.back;
    if (!two_sided) return false;
  }
  if (!side.back || (m.flags & kDoubleSided) != 0) add_found_emission(path, t, m, side.uv, d, hit.t);
  if (depth == bounces) return false;
  path.throughput *= reflectance_at(setup, t, m, side.uv);
  if (!survives(path, depth + 1)) return false;
  path.at = place_at(t, side.uv, side.back);
  return true;
}

// One bounce: a random direction, and rays towards each kind of light; the shader traces in one place.
bool bounce(inout Path path, int depth, inout PathSums sum) {
  vec2 u = next_vec2(path.random);
  vec2 circle = unit_circle(u.x);
  float r = sqrt(u.y);
  vec3 d = mirrored_above(to_world(path.at.normal, vec3(circle.x * r, circle.y * r, sqrt(max(0.0, 1 - u.y)))),
                          path.at.geometric_normal);
  for (uint kind = 0; kind < 4; ++kind) {
    Aim aim = Aim(Ray(path.at.position, d, 0, kInfinity), vec3(0), 0, vec2(0));
    bool is_aimed = kind == 3;
    if (kind == 0 && setup.emitter_count > 0) is_aimed = aim_at_emitter(path, aim);
    if (kind == 1 && setup.light_count > 0) is_aimed = aim_at_punctual_light(path, aim);
    if (kind == 2 && sky_power() > 0) is_aimed = aim_at_sky(path, aim);
    if (!is_aimed) continue;
    ++sum.rays;
    Hit hit = trace(setup.world, aim.ray, kind == 1 || kind == 2);
    if (kind == 3) return advance(path, d, hit, depth, sum);
    bool arrives = hit.number == kNoTriangle;
    if (kind == 0) {
      arrives = arrives || hit.t >= kArrived || side_of(setup, hit).number == aim.emitter;
      PathTriangle t = setup.triangles.at[aim.emitter];
      aim.factor *= emission_at(setup, t, setup.materials.at[t.material], aim.at);
    }
    if (arrives) path.value += aim.factor;
  }
  return false;
}

// A path from what a camera's ray has met. False where it ends at once.
bool start_from_eye(Hit hit, vec3 d, inout Path path, inout PathSums sum) {
  path.throughput = vec3(1), path.value = vec3(0);
  if (hit.number == kNoTriangle) {
    path.value = setup.background;
    if (setup.map_width > 0) path.value += smooth_sky_towards(d);
    return false;
  }
  ++sum.covered;
  Side side = side_of(setup, hit);
  PathTriangle t = setup.triangles.at[side.number];
  PathMaterial m = setup.materials.at[t.material];
  if ((m.flags & kUnlit) != 0) {
    path.value = base_color_at(setup, t, m, side.uv).xyz;
    return false;
  }
  path.value = emission_at(setup, t, m, side.uv);
  path.throughput = reflectance_at(setup, t, m, side.uv);
  path.at = place_at(t, side.uv, side.back);
  return largest(path.throughput) > 0;
}

void start_from_place(uint item, uint own_sample, inout Path path) {
  uint k = item;
  if ((flags & kOnePlaceEach) == 0) {
    uint first = first_place.at[item];
    k = first + own_sample % (first_place.at[item + 1] - first);
  }
  path.at = places.at[k];
  path.throughput = vec3(1), path.value = vec3(0);
  path.random = Random(path_seed(seed, item, own_sample), 0);
}

void add(inout PathSums sum, vec3 value) {
  double x = value.x, y = value.y, z = value.z, l = luminance(value);
  sum.r += x, sum.g += y, sum.b += z, sum.l += l;
  sum.r2 += x * x, sum.g2 += y * y, sum.b2 += z * z, sum.l2 += l * l;
}

void main() {
  uint k = (first_group + gl_WorkGroupID.x) * kPathThreads + gl_LocalInvocationID.x;
  if (k >= item_count) return;
  uint item = first_item + k / slices, begin = k % slices * samples_of_slice;
  PathSums sum = sums.at[k];
  for (uint s = first_sample; s < first_sample + sample_count; ++s) {
    if (s >= samples_of_slice || begin + s >= samples) break;
    Path path;
    bool goes_on = true;
    if ((flags & kPicture) != 0) {
      Ray ray = ray_of_pixel(camera, item, begin + s, seed, path.random);
      goes_on = start_from_eye(eye_hits.at[k], ray.direction, path, sum);
    } else {
      start_from_place(item, begin + s, path);
    }
    for (int depth = 0; goes_on; ++depth) goes_on = bounce(path, depth, sum);
    add(sum, path.value);
  }
  sums.at[k] = sum;
}
