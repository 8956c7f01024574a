// What the shaders of shadow maps share.
#include "scene.glsl"

layout(push_constant, scalar) uniform Push {
  mat4 clip_from_world;
  Vertices vertices;
  Materials materials;
  Instances instances;
  uint instance, material;
};
