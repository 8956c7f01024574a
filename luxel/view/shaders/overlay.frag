// What a bake is made of, as colours of its surfaces. They are linear light of what a screen shows.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "scene.glsl"
#include "luxel/view/draw/overlay_shared.h"

layout(binding = 0) uniform sampler2D light;
layout(binding = 1) uniform sampler2D map;
layout(binding = 2) uniform sampler2D texels;  // the three: one pixel or some for each texel
layout(binding = 3) uniform sampler2D errors;
layout(binding = 4) uniform sampler2D overlaps;
layout(binding = 5) uniform sampler2D second;

layout(location = 0) centroid in vec2 at_light;
layout(location = 1) in vec2 at_map;
layout(location = 2) in vec2 at_atlas;
layout(location = 3) in vec3 position;
layout(location = 4) in vec3 weights;
layout(location = 5) flat in uint chart;
layout(location = 6) in float clear;
layout(location = 0) out vec4 seen;

// view::Show
const uint irradiance = 3, checker = 4, density = 5, chart_colors = 6, seams = 7, overlapping = 8,
           texel_kinds = 9, standard_error = 10;
const float pi = 3.14159265358979;
const float most = 60000;  // of the picture's halves
const float line_width = 1.25;  // of seams, to each side [pixels]
const vec3 grey = vec3(0.55), seam_color = vec3(1, 0.25, 0.02), red = vec3(0.8, 0.02, 0.02);

#include "false_color.glsl"

/// Of squares of one texel, the share that is light in this pixel.
float share_of_light_squares(vec2 at) {
  vec2 width = max(fwidth(at), 1e-4);
  vec2 mean = 2 * (abs(fract((at - 0.5 * width) / 2) - 0.5) -
                   abs(fract((at + 0.5 * width) / 2) - 0.5)) / width;
  return 0.5 + 0.5 * mean.x * mean.y;
}

/// Texels over the surface, both as the pixel's neighbours have them.
float texels_per_metre(vec2 at) {
  vec2 x = dFdx(at), y = dFdy(at);
  float surface = length(cross(dFdx(position), dFdy(position)));
  return surface > 0 ? sqrt(abs(x.x * y.y - x.y * y.x) / surface) : 0;
}

/// A colour of its own for each, none dark: hues go round by the golden ratio.
vec3 color_of_chart(uint number) {
  vec3 hue = fract(float(number) * 0.61803399 + vec3(0, 2 / 3.0, 1 / 3.0));
  vec3 pure = clamp(abs(hue * 6 - 3) - 1, 0, 1);
  return linear(mix(vec3(0.95 - 0.1 * float(number % 3)), pure, 0.55));
}

bool is_on_seam() {
  vec3 pixels = weights / max(fwidth(weights), 1e-9);
  bvec3 is_seam = bvec3((chart & 1u) != 0, (chart & 2u) != 0, (chart & 4u) != 0);
  return any(bvec3(is_seam.x && pixels.x < line_width, is_seam.y && pixels.y < line_width,
                   is_seam.z && pixels.z < line_width));
}

void main() {
  Material m = materials.at[material];
  float alpha = texture(map, at_map).a * m.alpha * (1 - clear);
  vec2 size = vec2(textureSize(light, 0));
  vec3 normal = cross(dFdx(position), dFdy(position));
  float facing = abs(dot(normal, look.forward)) / max(length(normal), 1e-30);
  float shade = 0.7 + 0.3 * facing;
  float per_metre = texels_per_metre(at_atlas * size);
  float light_squares = share_of_light_squares(at_atlas * size);
  bool on_seam = is_on_seam();
  // All that looks at neighbours is behind us.
  if (alpha < m.cutoff) discard;
  if (culled == (gl_FrontFacing ? 2 : 1)) discard;

  vec2 scale = look.light_now.scale[m.page];
  vec3 e = mix(textureLod(light, at_light, 0).rgb * scale.x,
               textureLod(second, at_light, 0).rgb * scale.y, look.second_light);
  vec3 color = vec3(0);
  if (look.show == irradiance) color = false_color(value_of(e));
  if (look.show == checker) color = e / pi * look.exposure * mix(0.45, 1, light_squares);
  if (look.show == density) color = false_color(per_metre) * shade;
  if (look.show == chart_colors) color = color_of_chart(chart >> 3) * shade;
  if (look.show == seams) color = on_seam ? seam_color : grey * shade;
  if (look.show == overlapping)
    color = mix(grey, red, textureLod(overlaps, at_light, 0).r) * shade;
  if (look.show == texel_kinds) color = textureLod(texels, at_light, 0).rgb * shade;
  if (look.show == standard_error) color = textureLod(errors, at_light, 0).rgb * shade;
  seen = vec4(min(color, most), 1);
}
