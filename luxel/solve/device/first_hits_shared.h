// The rays of elements, and what they meet first. C++ and GLSL.
#ifndef LUXEL_SOLVE_DEVICE_FIRST_HITS_SHARED_H
#define LUXEL_SOLVE_DEVICE_FIRST_HITS_SHARED_H
#include "luxel/solve/device/rays_shared.h"
#include "luxel/trace/vulkan/world_shared.h"
SHARED_BEGIN

// Per kRaysTogether elements after each other: the first ray of each, the second of each and so on,
// in the order of cells.
OUT_BUFFER(Hits, Hit);

PUSH(HitsPush) {
  World world;
  REF(Elements) elements;
  REF(Hits) hits;
  uvec2 seed;  // of all elements
  uint element_count, samples;
  uint first_group;  // 64 for each tile of elements
};

SHARED_END
#endif
