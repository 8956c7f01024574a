// Two pictures of one view: beside one another, or how far they are apart.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "luxel/view/draw/beside_shared.h"

layout(binding = 0) uniform sampler2D first;
layout(binding = 1) uniform sampler2D second;
layout(binding = 2) uniform sampler2D first_exposed;
layout(binding = 3) uniform sampler2D second_exposed;
layout(binding = 4) uniform sampler2D flip;
layout(location = 0) out vec4 shown;

const float darkest = 1e-3;  // of white: what is darker differs by nothing that is seen

vec3 color_of(float t) {
  return unpackUnorm4x8(colors.at[uint(clamp(t, 0, 1) * 255 + 0.5)]).rgb;
}

float exposed_luminance(sampler2D picture, ivec2 at) {
  return dot(texelFetch(picture, at, 0).rgb, vec3(0.2126, 0.7152, 0.0722));
}

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  vec3 color;
  if (mode == 0) {
    float beyond = gl_FragCoord.x - line_at;
    color = beyond < 0 ? texelFetch(first, at, 0).rgb : texelFetch(second, at, 0).rgb;
    if (abs(beyond) < 2) color = vec3(abs(beyond) < 1 ? 1 : 0);
  } else if (mode == 1) {
    float a = exposed_luminance(first_exposed, at), b = exposed_luminance(second_exposed, at);
    color = color_of(abs(a - b) / (0.5 * (a + b) + darkest) / highest);
  } else {
    color = texelFetch(flip, at, 0).rgb;
  }
  shown = vec4(color, 1);
}
