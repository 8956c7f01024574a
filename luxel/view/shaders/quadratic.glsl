// What the shaders of quadratic light share: luxel/view/draw/quadratic.h.
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_scalar_block_layout : require

struct Triangle {
  vec3 corner[3];
  // E = ((A s + 2B t) + 2C) s + (D t + 2E) t + F, s and t the weights of the second and third corner
  vec3 irradiance[6];
  vec3 reflectance, emission;
  uint group, two_sided;
};
layout(buffer_reference, scalar) readonly buffer Triangles { Triangle at[]; };
layout(buffer_reference, scalar) readonly buffer Exact { vec4 at[]; };

layout(push_constant, scalar) uniform Push {
  mat4 clip_from_world;
  Triangles triangles;
  Exact exact;
  uint exact_width;  // 0: none
  float exposure;
  uint show;
};
