// What a surface sends to the eye, rho E / pi + L, by the quadratic function of its triangle.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "luxel/view/draw/quadratic_shared.h"

layout(location = 0) centroid in vec2 at;
layout(location = 1) flat in uvec2 group_and_sides;
layout(location = 2) flat in vec3 reflectance;
layout(location = 3) flat in vec3 emission;
layout(location = 4) flat in vec3 irradiance[6];
layout(location = 0) out vec4 seen;

const float pi = 3.14159265358979;
const float most = 60000;  // of the picture's halves

vec3 irradiance_here() {
  if (exact_width > 0) {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec4 known = exact.at[pixel.y * exact_width + pixel.x];
    if (floatBitsToUint(known.a) == group_and_sides.x) return known.rgb;
  }
  vec3 e = (irradiance[0] * at.x + irradiance[1] * at.y + irradiance[2]) * at.x +
           (irradiance[3] * at.y + irradiance[4]) * at.y + irradiance[5];
  return max(e, 0);
}

void main() {
  if (!gl_FrontFacing && group_and_sides.y == 0) discard;
  vec3 radiance;
  if (show == 1)
    radiance = irradiance_here() / pi;
  else if (show == 2)
    radiance = reflectance / exposure;
  else
    radiance = emission + reflectance * irradiance_here() / pi;
  seen = vec4(min(radiance * exposure, most), 1);
}
