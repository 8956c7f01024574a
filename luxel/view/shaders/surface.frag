// What a surface sends to the eye: rho E / pi + L, as luxel/display/draw.h has it.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "surface.glsl"

layout(binding = 0) uniform sampler2D light;
layout(binding = 1) uniform sampler2D map;
layout(binding = 2) uniform sampler2D metal;
layout(binding = 3) uniform sampler2D glow;
layout(binding = 4) uniform sampler2D through_share;
layout(binding = 5) uniform sampler2D through_tint;
layout(binding = 6) uniform sampler2D second;

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
layout(location = 0) out vec4 seen;

const float pi = 3.14159265358979;
const float most = 60000;  // of the picture's halves
const float max_reflectance = 0.99;  // scene::kMaxReflectance

// E at a place of the lightmap. Its second picture comes while light changes.
vec3 irradiance_at(vec2 place) {
  vec2 scale = light_scales.at[materials.at[material].page];
  vec3 first = textureLod(light, place, 0).rgb * scale.x;
  if (second_light == 0) return first;
  return mix(first, textureLod(second, place, 0).rgb * scale.y, second_light);
}

void main() {
  Material m = materials.at[material];
  vec4 base = texture(map, at_map) * vec4(m.base_color * tint, m.alpha);
  if (base.a < m.cutoff) discard;
  vec3 emitted = m.emission * texture(glow, at_glow).rgb;
  float metallic = clamp(m.metallic * texture(metal, at_metal).b, 0, 1);
  float through = 0;
  if (m.through > 0)
    through = clamp(m.through * texture(through_share, at_through_share).a, 0, 1);
  vec3 rho = clamp(base.rgb * ((1 - metallic) * (1 - through)), 0, max_reflectance);
  vec3 irradiance = irradiance_at(at_light);
  vec3 radiosity = rho * irradiance;
  if (through > 0) {
    vec3 tau = m.through_color * texture(through_tint, at_through_tint).rgb *
               (through * (1 - metallic));
    radiosity += clamp(tau, vec3(0), max_reflectance - rho) *
                 irradiance_at(at_light_behind);
  }
  vec3 radiance = m.unlit != 0 ? base.rgb : radiosity / pi + emitted;
  if (show == 1) radiance = irradiance / pi;
  if (show == 2) radiance = base.rgb * (1 - metallic) / exposure;
  seen = vec4(min(radiance * exposure, most), 1);
}
