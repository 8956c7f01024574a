// The surfaces of a scene and what lights them. C++ and GLSL.
#ifndef LUXEL_VIEW_DRAW_SCENE_SHARED_H
#define LUXEL_VIEW_DRAW_SCENE_SHARED_H
#include "luxel/gpu/shared_language.h"
SHARED_BEGIN

struct Vertex {
  vec3 position;
  vec2 uv0, uv1;
  vec2 light, light_behind;  // places in the lightmap: its own, that of the other side
  vec3 normal;               // 0: that of the facet
  vec3 color;
  float clear;  // 1 - alpha: where all corners have 0, no rounding leaves a hole
};
IN_BUFFER(Vertices, Vertex);

struct LookUp {
  vec3 u, v;  // u = dot(LookUp.u, (uv, 1))
  uint uv_set;
};

struct Material {
  vec3 base_color;
  float alpha;
  vec3 emission;
  float metallic;
  float cutoff;  // alpha below it is a hole
  uint page;     // of the lightmap
  uint unlit;
  vec3 through_color;  // of light that is scattered through
  float through;
  LookUp map, metal, glow, through_share, through_tint;
};
IN_BUFFER(Materials, Material);

struct Instance {
  vec4 row0, row1, row2;  // world from object
  vec3 emission_factor;
};
IN_BUFFER(Instances, Instance);

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
IN_BUFFER(Lamps, Lamp);

// Values that change from picture to picture.
IN_BLOCK(LightNow) {
  vec3 eye;
  uint lamp_count;
  REF(Lamps) lamps;
  REF(ShadowMaps) maps;
  float lamp_share;   // of their light, that is drawn
  uint unused;        // as C++ has it: the scales follow its struct
  REST(vec2, scale);  // of the lightmap's pages, for either picture: E = scale * picture
};

SHARED_END
#endif
