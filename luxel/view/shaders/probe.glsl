// What the shaders of probes share: luxel/view/draw/probe_drawing.cpp has the structs.
#include "look.glsl"

struct Probe {
  vec3 position;
  vec3 irradiance[9];  // light::Probe
};
layout(buffer_reference, scalar) readonly buffer Probes { Probe at[]; };

layout(push_constant, scalar) uniform Push {
  mat4 clip_from_world;
  Probes probes;
  Look look;  // where false colours are shown
  uint shows_false_colors;
  float exposure;
  float radius;
  uint slices, stacks;  // of a ball
};
