#version 460
#extension GL_GOOGLE_include_directive : require
#include "luxel/view/draw/inset_shared.h"

void main() {
  vec2 part = vec2(gl_VertexIndex == 1 || gl_VertexIndex == 2 || gl_VertexIndex == 4,
                   gl_VertexIndex == 2 || gl_VertexIndex == 4 || gl_VertexIndex == 5);
  gl_Position = vec4((vec2(corner) + part * vec2(size)) / picture * 2 - 1, 0, 1);
}
