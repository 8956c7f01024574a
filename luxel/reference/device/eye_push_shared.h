// The push constants of eye.comp. C++ and GLSL.
#ifndef LUXEL_REFERENCE_DEVICE_EYE_PUSH_SHARED_H
#define LUXEL_REFERENCE_DEVICE_EYE_PUSH_SHARED_H
#include "luxel/reference/device/paths_shared.h"
SHARED_BEGIN

PUSH(EyePush) {
  REF(PathSetup) setup;
  REF(Camera) camera;
  REF(Hits) hits;  // of the items
  uvec2 seed;
  uint first_pixel, item_count, slices, samples_of_slice, samples;
  uint first_sample;  // of each slice
  uint first_group;
};

SHARED_END
#endif
