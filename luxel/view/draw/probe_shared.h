// Probes, which are drawn as balls. C++ and GLSL.
#ifndef LUXEL_VIEW_DRAW_PROBE_SHARED_H
#define LUXEL_VIEW_DRAW_PROBE_SHARED_H
#include "luxel/view/draw/look_shared.h"
SHARED_BEGIN

struct Probe {
  vec3 position;
  ARRAY(vec3, 9) irradiance;  // light::Probe
};
IN_BUFFER(Probes, Probe);

PUSH(ProbePush) {
  mat4 clip_from_world;
  REF(Probes) probes;
  REF(Look) look;  // where false colours are shown
  uint shows_false_colors;
  float exposure;
  float radius;
  uint slices, stacks;  // of a ball
};

SHARED_END
#endif
