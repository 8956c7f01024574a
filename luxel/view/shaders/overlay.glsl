// What the shaders that look into a bake share: luxel/view/draw/overlay.cpp has the structs.
#include "look.glsl"

layout(push_constant, scalar) uniform Push {
  mat4 clip_from_world;
  Vertices vertices;
  Materials materials;
  Instances instances;
  Look look;
  uint instance, material;
  uint culled;  // faces that are left out: 0 none, 1 the back ones, 2 the front ones
};
