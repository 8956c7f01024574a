// Corners of triangles as they are; lines and discs as rectangles that face the eye.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shape.glsl"

layout(location = 0) out vec4 color;
layout(location = 1) out vec2 from_centre;  // of a disc, over its radius

vec4 clip_of(Corner c) {
  vec4 p = clip_from_world * vec4(c.place, 1);
  p.z += p.z * nearer + p.w * nearer_parallel;
  return p;
}

void main() {
  from_centre = vec2(0);
  int corner = gl_VertexIndex % 6;
  bool is_end = corner == 1 || corner == 2 || corner == 4;
  vec2 aside = corner == 2 || corner == 4 || corner == 5 ? vec2(1) : vec2(-1);
  if (kind == kTriangleShapes) {
    Corner c = corners.at[gl_VertexIndex];
    color = vec4(c.color, c.opacity);
    gl_Position = clip_of(c);
  } else if (kind == kLineShapes) {
    Corner first = corners.at[gl_VertexIndex / 6 * 2], last = corners.at[gl_VertexIndex / 6 * 2 + 1];
    Corner own = is_end ? last : first;
    color = vec4(own.color, own.opacity);
    vec4 a = clip_of(first), b = clip_of(last);
    // Of b.xy / b.w - a.xy / a.w the line, one end of which may lie behind the eye.
    vec2 along = (b.xy * a.w - a.xy * b.w) * picture;
    along = dot(along, along) > 0 ? normalize(along) : vec2(1, 0);
    gl_Position = is_end ? b : a;
    gl_Position.xy += vec2(-along.y, along.x) * aside * (width / picture) * gl_Position.w;
  } else {
    Corner c = corners.at[gl_VertexIndex / 6];
    color = vec4(c.color, c.opacity);
    from_centre = vec2(is_end ? 1 : -1, aside.x);
    gl_Position = clip_of(c);
    gl_Position.xy += from_centre * (width / picture) * gl_Position.w;
  }
}
