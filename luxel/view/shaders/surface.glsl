// What the shaders of surfaces share: luxel/view/draw/device_scene.h has the structs.
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_scalar_block_layout : require

struct Vertex {
  vec3 position;
  vec2 uv0, uv1;
  vec2 light, light_behind;  // places in the lightmap: its own, that of the other side
  vec3 color;
};
struct LookUp {
  vec3 u, v;  // u = dot(LookUp.u, (uv, 1))
  uint uv_set;
};
struct Material {
  vec3 base_color;
  float alpha;
  vec3 emission;
  float metallic;
  float cutoff;
  uint page;  // of the lightmap
  uint unlit;
  vec3 through_color;  // of light that is scattered through
  float through;
  LookUp map, metal, glow, through_share, through_tint;
};
struct Instance {
  vec4 row0, row1, row2;  // world from object
};

layout(buffer_reference, scalar) readonly buffer Vertices { Vertex at[]; };
layout(buffer_reference, scalar) readonly buffer Materials { Material at[]; };
layout(buffer_reference, scalar) readonly buffer Instances { Instance at[]; };
layout(buffer_reference, scalar) readonly buffer LightScales { vec2 at[]; };  // of pages

layout(push_constant, scalar) uniform Push {
  mat4 clip_from_world;
  Vertices vertices;
  Materials materials;
  Instances instances;
  LightScales light_scales;
  uint instance, material;
  float exposure;
  uint show;
  float second_light;  // its share
};
