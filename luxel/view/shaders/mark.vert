// A rectangle along the line from one end to the other, with room for round ends.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "luxel/view/draw/mark_shared.h"

layout(location = 0) out vec2 at;

void main() {
  vec2 along = distance(from, to) > 0 ? normalize(to - from) : vec2(1, 0);
  vec2 aside = vec2(-along.y, along.x);
  float reach = radius + edge_width + 1;
  bool is_end = gl_VertexIndex == 1 || gl_VertexIndex == 2 || gl_VertexIndex == 4;
  bool is_left = gl_VertexIndex == 2 || gl_VertexIndex == 4 || gl_VertexIndex == 5;
  at = (is_end ? to + along * reach : from - along * reach) + aside * (is_left ? reach : -reach);
  gl_Position = vec4(at / picture * 2 - 1, 0, 1);
}
