#version 460
#extension GL_GOOGLE_include_directive : require
#include "luxel/view/draw/mark_shared.h"

layout(location = 0) in vec2 at;
layout(location = 0) out vec4 shown;

void main() {
  vec2 along = to - from;
  float part = dot(along, along) > 0 ? clamp(dot(at - from, along) / dot(along, along), 0, 1) : 0;
  float away = distance(at, from + along * part);
  float inside = clamp(radius + 0.5 - away, 0, 1);
  float covered = clamp(radius + edge_width + 0.5 - away, 0, 1);
  shown = vec4(mix(edge, color, inside) * covered, covered);
}
