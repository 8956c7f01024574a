// What is shown of a bake: luxel/view/draw/overlay.cpp has the struct.
#include "scene.glsl"

layout(buffer_reference, scalar) readonly buffer Corners { uint at[]; };
/// Per triangle: its chart, times eight, and a bit for each edge that is a seam.
layout(buffer_reference, scalar) readonly buffer Charts { uint at[]; };
/// The scene's triangles, what is shown, and 256 false colours, 0xbbggrr.
layout(buffer_reference, scalar) readonly buffer Look {
  Corners corners;
  Charts charts;
  LightNow light_now;
  float second_light;  // its share
  uint show, channel;
  float low, high;
  uint is_logarithmic;
  float exposure;
  vec3 forward;
  uint colors[256];
};
