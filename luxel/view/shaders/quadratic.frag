// What a surface sends to the eye, rho E / pi + L, by the quadratic function of its triangle.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "quadratic.glsl"

layout(location = 0) centroid in vec2 at;
layout(location = 1) flat in uint triangle;
layout(location = 0) out vec4 seen;

const float pi = 3.14159265358979;
const float most = 60000;  // of the picture's halves

vec3 coefficient(uint k) { return triangles.at[triangle].irradiance[k]; }

vec3 irradiance() {
  if (exact_width > 0) {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec4 known = exact.at[pixel.y * exact_width + pixel.x];
    if (floatBitsToUint(known.a) == triangles.at[triangle].group) return known.rgb;
  }
  vec3 e = (coefficient(0) * at.x + coefficient(1) * at.y + coefficient(2)) * at.x +
           (coefficient(3) * at.y + coefficient(4)) * at.y + coefficient(5);
  return max(e, 0);
}

void main() {
  if (!gl_FrontFacing && triangles.at[triangle].two_sided == 0) discard;
  vec3 radiance;
  if (show == 1)
    radiance = irradiance() / pi;
  else if (show == 2)
    radiance = triangles.at[triangle].reflectance / exposure;
  else
    radiance = triangles.at[triangle].emission +
               triangles.at[triangle].reflectance * irradiance() / pi;
  seen = vec4(min(radiance * exposure, most), 1);
}
