// What a surface sends to the eye, rho E / pi + L, by the quadratic function of its triangle.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "quadratic.glsl"

layout(location = 0) centroid in vec2 at;
layout(location = 1) flat in uint triangle;
layout(location = 0) out vec4 seen;

const float pi = 3.14159265358979;
const float most = 60000;  // of the picture's halves

vec3 irradiance_of(Triangle t) {
  float u = at.x, v = at.y;
  vec3 e = (t.irradiance[0] * u + t.irradiance[1] * v + t.irradiance[2]) * u +
           (t.irradiance[3] * v + t.irradiance[4]) * v + t.irradiance[5];
  if (exact_width == 0) return max(e, 0);
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec4 known = exact.at[pixel.y * exact_width + pixel.x];
  return floatBitsToUint(known.a) == t.group ? known.rgb : max(e, 0);
}

void main() {
  Triangle t = triangles.at[triangle];
  if (!gl_FrontFacing && t.two_sided == 0) discard;
  vec3 e = irradiance_of(t);
  vec3 radiance = t.emission + t.reflectance * e / pi;
  if (show == 1) radiance = e / pi;
  if (show == 2) radiance = t.reflectance / exposure;
  seen = vec4(min(radiance * exposure, most), 1);
}
