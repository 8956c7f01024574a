// The light that rays see outside of the scene. C++ and GLSL.
#ifndef LUXEL_SOLVE_DEVICE_ESCAPED_SHARED_H
#define LUXEL_SOLVE_DEVICE_ESCAPED_SHARED_H
#include "luxel/solve/device/rays_shared.h"
#include "luxel/solve/device/surroundings_shared.h"
SHARED_BEGIN

PUSH(EscapedPush) {
  REF(Surroundings) around;
  REF(Elements) elements;
  REF(AllShares) shares;
  // The chunk has these:
  REF(RaySlots) slots;
  REF(TileRows) rows;
  REF(StoredHits) hits;
  REF(AllLight) light;  // per slot
  RaySeeds seeds;
  uint slot_count;
  uint first_group;
};

SHARED_END
#endif
