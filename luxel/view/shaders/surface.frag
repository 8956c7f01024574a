// What a surface sends to the eye: rho E / pi + L, as luxel/display/draw.h has it.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "scene.glsl"
#include "luxel/view/draw/surface_shared.h"

layout(binding = 0) uniform sampler2D light;
layout(binding = 1) uniform sampler2D map;
layout(binding = 2) uniform sampler2D metal;
layout(binding = 3) uniform sampler2D glow;
layout(binding = 4) uniform sampler2D through_share;
layout(binding = 5) uniform sampler2D through_tint;
layout(binding = 6) uniform sampler2D second;
layout(binding = 7) uniform sampler2DShadow shadow_maps;
layout(binding = 8) uniform sampler2D shadow_depth;

// At pixels that a triangle covers in part, the middle can lie outside of it: far away in the atlas,
// on nothing, where the triangle is seen edge-on.
layout(location = 0) centroid in vec2 at_light;
layout(location = 1) centroid in vec2 at_light_behind;
layout(location = 2) in vec2 at_map;
layout(location = 3) in vec2 at_metal;
layout(location = 4) in vec2 at_glow;
layout(location = 5) in vec2 at_through_share;
layout(location = 6) in vec2 at_through_tint;
layout(location = 7) in vec3 tint;
layout(location = 8) in vec3 from_eye;
layout(location = 9) centroid in vec3 from_eye_inside;
layout(location = 10) in vec3 smooth_normal;
layout(location = 11) flat in float turned;
layout(location = 12) in float clear;
layout(location = 0) out vec4 seen;

// What a pipeline is made for: branches that are not taken cost as much as those that are where
// pixels are drawn side by side.
layout(constant_id = 0) const uint lamps_drawn = 2;     // 0: none, 1: with sharp shadows, 2: all
layout(constant_id = 1) const bool lets_through = true;  // m.through may be > 0
layout(constant_id = 2) const bool fades = true;         // second_light may be > 0
layout(constant_id = 3) const bool has_more = true;      // it may glow, or be metal

const float pi = 3.14159265358979;
const float most = 60000;  // of the picture's halves
const float max_reflectance = 0.99;  // scene::kMaxReflectance

// Over a turn.
float turn_of_place() {
  return 6.28318531 * fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715))));
}

#include "direct.glsl"
#include "smooth.glsl"

// The front of the surface; a coarse grid of pixels knows it.
vec3 facet_normal() {
  vec3 facet = normalize(cross(dFdy(from_eye), dFdx(from_eye)));  // looks at the eye
  return gl_FrontFacing == (turned < 0) ? -facet : facet;
}

// A place of the surface that the triangle covers: beside it shadows may be those of others. Some
// drivers interpolate there with the depth of the pixel's middle, and leave the facet's plane.
vec3 place_from_eye(vec3 facet) {
  return from_eye_inside + facet * dot(from_eye - from_eye_inside, facet);
}

// As scene::shading_normal().
vec3 normal_on(vec3 facet) {
  vec3 n = normalize(smooth_normal);
  float side = dot(n, facet);
  return !(abs(side) >= 1e-3) ? facet : side < 0 ? -n : n;
}

// E at a place of the lightmap. Its second picture comes while light changes.
vec3 irradiance_at(vec2 place) {
  vec2 scale = light_now.scale[materials.at[material].page];
  vec3 first = smooth_light(light, place) * scale.x;
  if (!fades) return first;
  return mix(first, smooth_light(second, place) * scale.y, second_light);
}

void main() {
  Material m = materials.at[material];
  vec3 facet = facet_normal();
  vec4 base = texture(map, at_map) * vec4(m.base_color * tint, m.alpha * (1 - clear));
  if (base.a < m.cutoff) discard;
  vec3 emitted = vec3(0);
  float metallic = 0;
  if (has_more) {
    emitted = m.emission * texture(glow, at_glow).rgb * instances.at[instance].emission_factor;
    metallic = clamp(m.metallic * texture(metal, at_metal).b, 0, 1);
  }
  float through = 0;
  if (lets_through)
    through = clamp(m.through * texture(through_share, at_through_share).a, 0, 1);
  vec3 rho = clamp(base.rgb * ((1 - metallic) * (1 - through)), 0, max_reflectance);
  vec3 irradiance = irradiance_at(at_light), behind = vec3(0);
  if (lamps_drawn > 0) {
    vec3 place = light_now.eye + place_from_eye(facet), n = normal_on(facet);
    irradiance += light_now.lamp_share * direct_light(place, n, facet);
    if (lets_through) behind = light_now.lamp_share * direct_light(place, -n, -facet);
  }
  vec3 radiosity = rho * irradiance;
  if (lets_through) {
    vec3 tau = m.through_color * texture(through_tint, at_through_tint).rgb *
               (through * (1 - metallic));
    radiosity += clamp(tau, vec3(0), max_reflectance - rho) *
                 (irradiance_at(at_light_behind) + behind);
  }
  vec3 radiance = m.unlit != 0 ? base.rgb : radiosity / pi + emitted;
  if (show == 1) radiance = irradiance / pi;
  if (show == 2) radiance = base.rgb * (1 - metallic) / exposure;
  seen = vec4(min(radiance * exposure, most), 1);
}
