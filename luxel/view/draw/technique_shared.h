// Surfaces by techniques of local illumination and of hemicube radiosity. C++ and GLSL.
#ifndef LUXEL_VIEW_DRAW_TECHNIQUE_SHARED_H
#define LUXEL_VIEW_DRAW_TECHNIQUE_SHARED_H
#include "luxel/view/draw/scene_shared.h"
SHARED_BEGIN

struct LitElement {
  vec3 irradiance, reflectance;
};
IN_BUFFER(LitElements, LitElement);

struct Phong {
  vec3 specular;
  float sharpness;
};
IN_BUFFER(Highlights, Phong);

// The viewer, and the one light of local illumination.
IN_BLOCK(Looking) {
  vec3 eye;
  uint is_parallel;
  vec3 back;  // against the view
  vec3 ambient, light, to_light;
};

PUSH(TechniquePush) {
  mat4 clip_from_world;
  REF(SurfaceCorners) corners;
  REF(LitElements) elements;
  REF(Highlights) highlights;
  REF(Materials) materials;
  REF(Looking) looking;
  uint material, technique;
  float exposure;
};

SHARED_END
#endif
