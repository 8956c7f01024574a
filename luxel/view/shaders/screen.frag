// Exposed light to what a screen shows: luxel/display/tone_map.h.
#version 460
#extension GL_EXT_scalar_block_layout : require

layout(push_constant, scalar) uniform Push {
  uint curve;  // display::ToneMap; of colours: clamp
};
layout(binding = 0) uniform sampler2D exposed;
layout(location = 0) out vec4 shown;

float luminance(vec3 c) { return dot(c, vec3(0.2126, 0.7152, 0.0722)); }

float shoulder(float x) {
  const float a = 0.5;
  if (x <= a) return x;
  float t = (x - a) / (1 - a);
  return a + (1 - a) * (1 - 1 / (1 + t));
}

vec3 compress(vec3 c) {
  float m = max(max(c.r, c.g), c.b);
  if (!(m > 0)) return vec3(0);
  float f = shoulder(m), kept = 1 / (1 + 0.15 * max(0, m - 1));
  return f + (c * (f / m) - f) * kept;
}

vec3 on_curve(vec3 c) {
  if (curve == 0) return compress(c);
  if (curve == 1) return c / (1 + c);
  if (curve == 2) {
    float y = luminance(c);
    return c * ((1 + y / 16) / (1 + y));
  }
  if (curve == 3) return (c * (2.51 * c + 0.03)) / (c * (2.43 * c + 0.59) + 0.14);
  return c;
}

vec3 srgb(vec3 c) {
  return mix(1.055 * pow(max(c, 1e-9), vec3(1 / 2.4)) - 0.055, 12.92 * c,
             vec3(lessThanEqual(c, vec3(0.0031308))));
}

void main() {
  vec3 c = max(texelFetch(exposed, ivec2(gl_FragCoord.xy), 0).rgb, 0);
  shown = vec4(srgb(clamp(on_curve(c), 0, 1)), 1);
}
