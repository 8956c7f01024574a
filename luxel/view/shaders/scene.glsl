// A scene's buffers: luxel/view/draw/device_scene.h has the structs.
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_scalar_block_layout : require

struct Vertex {
  vec3 position;
  vec2 uv0, uv1;
  vec2 light, light_behind;  // places in the lightmap: its own, that of the other side
  vec3 normal;  // 0: that of the facet
  vec3 color;
  float clear;  // 1 - alpha: where all corners have 0, no rounding leaves a hole
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
  vec3 emission_factor;
};

layout(buffer_reference, scalar) readonly buffer Vertices { Vertex at[]; };
layout(buffer_reference, scalar) readonly buffer Materials { Material at[]; };
layout(buffer_reference, scalar) readonly buffer Instances { Instance at[]; };

struct Lamp {
  vec3 intensity;
  uint kind;  // scene::PunctualLight::Kind
  vec3 position;
  float range_m;
  vec3 direction;
  float cos_outer;
  float cone;  // 1 over what the cosines of the two cones differ by
  uint first_map, map_count;
  uint looks_all_round;
  float tan_radius;  // of half the angle of its disc
};
struct ShadowMap {
  mat4 clip_from_world;
  vec2 corner;
  float side;
  float texel_m, depth_m;
};
layout(buffer_reference, scalar) readonly buffer Lamps { Lamp at[]; };
layout(buffer_reference, scalar) readonly buffer ShadowMaps { ShadowMap at[]; };
// What changes from picture to picture.
layout(buffer_reference, scalar) readonly buffer LightNow {
  vec3 eye;
  uint lamp_count;
  Lamps lamps;
  ShadowMaps maps;
  float lamp_share;
  uint unused;
  vec2 scale[];  // of the lightmap's pages
};
