// Light straight from its sources: luxel/light/direct_light.h. A thread takes a place, and its shadow
// rays one after the other. Each kind of source is a step of its own, which adds to what those before
// it have found: so a shader traces in one place only, and is compiled soon.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_shader_explicit_arithmetic_types_float64 : enable
#include "luxel/trace/vulkan/shaders/hierarchy.glsl"
#include "luxel/base/both_directions.h"
#include "lights.glsl"
#include "shadow_rays.glsl"
#include "light_values.glsl"
#include "draw_lights.glsl"
layout(local_size_x = kDirectThreads) in;

layout(constant_id = 1) const uint kStep = 0;

// Traces shadow rays at a triangle: `count` points of it that lie above the horizon, or, of one that
// stands for its neighbours, one at random.
void aim_at_triangle(TriangleLight light, Source s, uint count, Receiver r, inout Sum sum) {
  LightTriangle triangle = triangle_of(light);
  SphericalTriangle spherical = spherical_triangle(r.position, light.a, light.b, light.c);
  bool front = dot(r.position - light.a, light.normal) > 0;
  uvec2 seed = hash64(r.seed, uvec2(light.triangle, light.instance));
  if (light.piece > 0 && !s.drawn) seed = hash64(seed, uvec2(light.piece, 0));
  uint kept = 0, most = s.drawn ? (front || light.two_sided != 0 ? 1 : 0) : 8 * count + 64;
  for (uint k = 0; kept < count && k < most; ++k) {
    vec2 u = s.drawn ? random_vec2(seed) : sobol_owen_2d(k, seed);
    LightPoint point = point_of_light(triangle, spherical, r.position, r.normal, u);
    if (point.weight <= 0) continue;
    ++kept;
    // The ray ends just before the light, which must not block it.
    vec3 end = off_surface(point.target, front ? light.normal : -light.normal, light.size_m);
    float w = s.drawn ? point.weight * point.measure : point.weight;
    add_shadow_ray(s, sum, r, w, radiance_at(light, point.at) * w, end - r.position, 1 - 1e-4);
  }
  add_source(s, sum);
}

// A source whose light is exact but for the visible share.
Source exact_source(TriangleLight light, float whole, float chance, uint count) {
  Source s = new_source(whole / chance, count);
  s.exact = true;
  s.unshadowed = whole * luminance(light.radiance) / chance;
  return s;
}

// Few lights: rays are shared out in proportion to what each brings.
void aim_at_all_triangles(Receiver r, inout Sum sum) {
  float whole[kMaxAllTriangles];
  float total = 0;
  uint shining = 0;
  for (uint i = 0; i < setup.triangle_count; ++i) {
    TriangleLight light = setup.triangles.at[i];
    whole[i] = irradiance_per_radiance(triangle_of(light), r.position, r.normal);
    total += whole[i] * luminance(light.radiance);
    if (whole[i] > 0) ++shining;
  }
  if (!(total > 0)) return;
  float owed = random_float(hash64(r.seed, uvec2(0x11, 0)));
  float least = samples >= 2 * shining ? 1.0 : 0.0;
  for (uint i = 0; i < setup.triangle_count; ++i) {
    if (whole[i] <= 0) continue;
    TriangleLight light = setup.triangles.at[i];
    float deserved = max(least, float(samples) * (whole[i] * luminance(light.radiance)) / total);
    uint count = rounded(deserved);
    if (deserved < 1) {
      owed += deserved;
      count = owed >= 1 ? 1 : 0;
      owed -= float(count);
    }
    if (count == 0) continue;
    aim_at_triangle(light, exact_source(light, whole[i], min(1.0, deserved), count), count, r, sum);
  }
}

void aim_at_drawn_triangles(Receiver r, inout Sum sum) {
  float start = random_float(hash64(r.seed, uvec2(0x11, 0)));
  Draws draws = begin_draws(false, samples, samples == 1 ? 1 : kMaxCut, start, r);
  Draw draw;
  while (next_draw(draws, r, draw)) {
    TriangleLight light = setup.triangles.at[draw.leaf];
    Source s = new_source(1 / draw.chance, 1);
    s.drawn = true;
    if (draw.chance >= 1) {
      float whole = irradiance_per_radiance(triangle_of(light), r.position, r.normal);
      if (whole <= 0) continue;
      s = exact_source(light, whole, 1, draw.count);
    }
    aim_at_triangle(light, s, s.drawn ? 1 : draw.count, r, sum);
  }
}

// `number`: of the light.
void aim_at_punctual(uint number, float chance, Receiver r, inout Sum sum) {
  PunctualLight light = setup.punctual.at[number];
  Incidence met = incidence_at(light, r.position);
  float cosine = dot(met.towards, r.normal);
  bool disc = light.has_disc != 0;
  if (max(met.irradiance.x, max(met.irradiance.y, met.irradiance.z)) <= 0 || (cosine <= 0 && !disc)) return;
  Source s = new_source(0, disc ? samples : 1);
  s.exact = true, s.drawn = chance < 1, s.tint = met.irradiance;
  uvec2 seed = hash64(r.seed, uvec2(0x5000 + number, 0));
  for (uint k = 0; k < s.planned; ++k) {
    vec3 direction = met.towards;
    float w = 1;
    if (disc) {
      vec2 u = sobol_owen_2d(k, seed);
      direction = to_world(-light.direction, direction_in_disc(light.disc_height, u, unit_circle(u.x)));
      w = max(0.0, dot(direction, r.normal));
      if (w <= 0) continue;
    }
    add_shadow_ray(s, sum, r, w, vec3(w), direction, met.reach_m);
  }
  // Over the disc the cosine averages to that of its centre while all of it is above the horizon.
  float seen = disc ? s.sum_weight / float(samples) : cosine;
  bool whole = disc && s.rays == samples;
  s.scale = (whole ? max(cosine, 0.0) : seen) / chance;
  s.unshadowed = luminance(met.irradiance) * s.scale;
  add_source(s, sum);
}

// All of them, or, of many, those without a place.
void aim_at_punctual_lights(Receiver r, inout Sum sum) {
  bool all = setup.punctual_count <= kMaxAllPunctual;
  for (uint i = 0; i < setup.punctual_count; ++i)
    if (all || setup.punctual.at[i].kind == kDirectional) aim_at_punctual(i, 1, r, sum);
}

void aim_at_drawn_punctual_lights(Receiver r, inout Sum sum) {
  float start = random_float(hash64(r.seed, uvec2(0x12, 0)));
  Draws draws = begin_draws(true, kMaxAllPunctual, kMaxCut, start, r);
  Draw draw;
  while (next_draw(draws, r, draw)) aim_at_punctual(setup.punctual_order.at[draw.leaf], draw.chance, r, sum);
}

// The bright texel at a part u of the power.
uint bright_texel_at(float u) {
  double at = double(u) * setup.below.at[setup.bright_count];
  uint k = setup.guide.at[uint(double(u) * double(setup.bright_count))];
  while (k + 1 < setup.bright_count && setup.below.at[k + 1] <= at) ++k;
  return k;
}

void aim_at_bright_texels(Receiver r, inout Sum sum) {
  uvec2 seed = hash64(r.seed, uvec2(0x13, 0));
  Source s = new_source(1 / float(samples), samples);
  double power = setup.below.at[setup.bright_count];
  for (uint k = 0; k < samples; ++k) {
    vec2 u = sobol_owen_2d(k, seed);
    uint texel = bright_texel_at(u.x);
    double from = setup.below.at[texel];
    double within = clamp((double(u.x) * power - from) / (setup.below.at[texel + 1] - from), double(0), double(1));
    uint pixel = setup.bright_texels.at[texel];
    uint row = pixel / uint(setup.map_width);
    double upper = setup.row_cosine.at[row], lower = setup.row_cosine.at[row + 1];
    vec3 direction = direction_in_column(setup.map_width, setup.rotation_rad, int(pixel % uint(setup.map_width)),
                                         float(within), upper + (lower - upper) * double(u.y));
    vec3 radiance = setup.pixels.at[pixel];
    radiance *= float(power / double(luminance(radiance)));
    float w = folded_cosine(direction, r.normal, r.geometric_normal);
    add_shadow_ray(s, sum, r, w, radiance * w, direction, uintBitsToFloat(0x7f800000u));
  }
  add_source(s, sum);
}

void main() {
  uint i = (first_group + gl_WorkGroupID.x) * kDirectThreads + gl_LocalInvocationID.x;
  if (i >= count) return;
  Receiver r = receivers.at[i];
  Sum sum = Sum(light.at[i], 0, 0, 0);
  switch (kStep) {
    case kAllTriangles: aim_at_all_triangles(r, sum); break;
    case kDrawnTriangles: aim_at_drawn_triangles(r, sum); break;
    case kPunctualLights: aim_at_punctual_lights(r, sum); break;
    case kDrawnPunctualLights: aim_at_drawn_punctual_lights(r, sum); break;
    case kBrightTexels: aim_at_bright_texels(r, sum); break;
  }
  float drawn = drawn_variance(sum);
  sum.light.variance += drawn, sum.light.split_variance += drawn;
  light.at[i] = sum.light;
}
