// The exposed radiance that screen.frag shows in a shape's colour.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shape.glsl"

layout(location = 0) in vec4 color;
layout(location = 1) in vec2 from_centre;
layout(location = 0) out vec4 seen;

const float brightest = 0.9;  // linear: more would outshine what is beside it in a pixel

float luminance(vec3 c) { return dot(c, vec3(0.2126, 0.7152, 0.0722)); }

float before_shoulder(float y) {
  const float a = 0.5;
  if (y <= a) return y;
  float u = (y - a) / (1 - a);
  return a + (1 - a) * u / (1 - u);
}

// What compress() of screen.frag makes this colour of.
vec3 before_compress(vec3 c) {
  float f = luminance(c);
  if (!(f > 0)) return vec3(0);
  float room = 1 - f, got = max(max(c.r, c.g), c.b) - f;
  vec3 scaled = c;
  if (got > 0.5 * room) scaled = f + (c - f) * (room * before_shoulder(min(got / room, brightest)) / got);
  return max(scaled, 0) * (before_shoulder(f) / f);
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
