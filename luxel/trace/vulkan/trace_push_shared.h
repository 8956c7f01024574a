// The push constants of closest.comp and occluded.comp, which have `Answers`. C++ and GLSL.
#ifndef LUXEL_TRACE_VULKAN_TRACE_PUSH_SHARED_H
#define LUXEL_TRACE_VULKAN_TRACE_PUSH_SHARED_H
#include "luxel/trace/vulkan/world_shared.h"
SHARED_BEGIN

PUSH(TracePush) {
  World world;
  REF(Vectors) rays;
  REF(Answers) answers;
  uint first, end;  // of the rays that are traced
};

SHARED_END
#endif
