#version 460
#extension GL_GOOGLE_include_directive : require
#include "luxel/view/draw/inset_shared.h"

layout(location = 0) out vec4 shown;

void main() {
  uvec2 at = min(uvec2(gl_FragCoord.xy) - corner, size - 1);
  vec4 pixel = unpackUnorm4x8(pixels.at[at.y * size.x + at.x]);
  shown = vec4(pixel.rgb * pixel.a, pixel.a);
}
