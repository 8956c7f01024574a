// All of the screen, infinitely far away.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "luxel/view/draw/behind_shared.h"

layout(location = 0) out vec3 towards;

void main() {
  vec2 corner = vec2(gl_VertexIndex == 1 ? 3 : -1, gl_VertexIndex == 2 ? 3 : -1);
  towards = forward + right * corner.x - up * corner.y;
  gl_Position = vec4(corner, 0, 1);
}
