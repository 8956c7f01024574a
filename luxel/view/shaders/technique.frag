// The techniques of [Rodriguez06], sections 5.3 and 5.4, normals, radiosity, and triangles in
// colours.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "technique.glsl"

// Those of surface.frag, whose bindings they share.
layout(binding = 1) uniform sampler2D map;
layout(binding = 2) uniform sampler2D metal;
layout(binding = 3) uniform sampler2D glow;
layout(binding = 4) uniform sampler2D through_share;

layout(location = 0) in vec2 at_map;
layout(location = 1) in vec2 at_metal;
layout(location = 2) in vec2 at_glow;
layout(location = 3) in vec2 at_through_share;
layout(location = 4) in vec3 tint;
layout(location = 5) in vec3 normal;
layout(location = 6) in vec3 to_viewer;
layout(location = 7) in vec3 place;
layout(location = 8) in vec3 light;
layout(location = 9) in vec3 weights;
layout(location = 10) flat in vec3 facing;
layout(location = 11) flat in vec3 highlight;
layout(location = 12) flat in uint item;
layout(location = 13) in float clear;
layout(location = 0) out vec4 seen;

const float pi = 3.14159265358979;
const float most = 60000;  // of the picture's halves
const float max_reflectance = 0.99;  // scene::kMaxReflectance

vec3 linear(vec3 v) {
  return mix(pow((v + 0.055) / 1.055, vec3(2.4)), v / 12.92, vec3(lessThanEqual(v, vec3(0.04045))));
}

// display::local_color
vec3 local_color(vec3 color, vec3 specular, vec2 lit) {
  vec3 sum = looking.ambient * color;
  bool has_diffuse = technique == cad || technique == cads || technique == cads_pixel;
  bool has_specular = technique >= cas && technique <= cads_pixel;
  if (has_diffuse) sum += looking.light * color * lit.x;
  if (has_specular) sum += looking.light * specular * lit.y;
  return clamp(sum, 0, 1);
}

vec3 local_light(vec3 color) {
  Phong phong = highlights.at[material];
  if (technique == c) return color;
  if (technique == ca) return local_color(color, vec3(0), vec2(0));
  if (technique >= cas_pixel)
    return local_color(color, phong.specular,
                       lit_by_light(normalize(normal), normalize(to_viewer), phong.sharpness));
  vec3 sum = vec3(0);
  for (uint k = 0; k < 3; ++k)
    sum += weights[k] * local_color(color, phong.specular, vec2(facing[k], highlight[k]));
  return sum;
}

// L of radiosity.
vec3 radiance(vec4 base) {
  Material m = materials.at[material];
  if (m.unlit != 0) return base.rgb;
  vec3 emitted = m.emission * texture(glow, at_glow).rgb;
  if (technique == radiosity_vertex) return light / pi + emitted;
  float metallic = clamp(m.metallic * texture(metal, at_metal).b, 0, 1);
  float through = 0;
  if (m.through > 0)
    through = clamp(m.through * texture(through_share, at_through_share).a, 0, 1);
  vec3 rho = clamp(base.rgb * ((1 - metallic) * (1 - through)), 0, max_reflectance);
  return rho * light / pi + emitted;
}

void main() {
  Material m = materials.at[material];
  vec4 base = texture(map, at_map) * vec4(m.base_color * tint, m.alpha * (1 - clear));
  float looks_at_viewer = abs(dot(normalize(normal), way_to_viewer(place)));
  if (base.a < m.cutoff) discard;
  vec3 color;
  if (technique < normals) color = local_light(clamp(base.rgb, 0, 1));
  else if (technique == normals) color = vec3(0.15 + 0.55 * looks_at_viewer);
  else if (technique == elements_in_colours) color = linear(unpackUnorm4x8(item).rgb);
  else color = radiance(base);
  seen = vec4(min(color * exposure, most), 1);
}
