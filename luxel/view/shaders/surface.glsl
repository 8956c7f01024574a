// What the shaders of surfaces share.
#include "scene.glsl"

layout(push_constant, scalar) uniform Push {
  mat4 clip_from_world;
  Vertices vertices;
  Materials materials;
  Instances instances;
  LightNow light_now;
  uint instance, material;
  float exposure;
  uint show;
  float second_light;  // its share
};
