// A scene's buffers.
#extension GL_GOOGLE_include_directive : require
#include "luxel/gpu/shared_language.h"

// view::ShadowMap
struct ShadowMap {
  mat4 clip_from_world;
  vec2 corner;
  float side;
  float texel_m, depth_m;
};
IN_BUFFER(ShadowMaps, ShadowMap);
#include "luxel/view/draw/scene_shared.h"
