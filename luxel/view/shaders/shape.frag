// The exposed radiance that screen.frag shows in a shape's colour.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shape.glsl"

layout(location = 0) in vec4 color;
layout(location = 1) in vec2 from_centre;
layout(location = 0) out vec4 seen;

const float brightest = 0.9;  // linear: more would outshine what is beside it in a pixel

float before_shoulder(float y) {
  const float a = 0.5;
  if (y <= a) return y;
  float u = (y - a) / (1 - a);
  return a + (1 - a) * u / (1 - u);
}

// What compress() of screen.frag makes this colour of.
vec3 before_compress(vec3 c) {
  float f = max(max(c.r, c.g), c.b);
  if (!(f > 0)) return vec3(0);
  float m = before_shoulder(f), kept = 1 / (1 + 0.15 * max(0, m - 1));
  return max(f + (c - f) / kept, 0) * (m / f);
}

vec3 linear(vec3 srgb) {
  return mix(pow((srgb + 0.055) / 1.055, vec3(2.4)), srgb / 12.92,
             vec3(lessThanEqual(srgb, vec3(0.04045))));
}

void main() {
  if (dot(from_centre, from_centre) > 1) discard;
  vec3 c = min(linear(color.rgb), brightest);
  if (curve == 0) c = before_compress(c);
  if (curve == 1) c = c / (1 - c);
  seen = vec4(c, 1) * color.a;
}
