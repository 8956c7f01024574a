// Light that elements gather from the map by their rays. C++ and GLSL.
#ifndef LUXEL_SOLVE_DEVICE_SWEEP_SHARED_H
#define LUXEL_SOLVE_DEVICE_SWEEP_SHARED_H
#include "luxel/solve/device/rays_shared.h"
SHARED_BEGIN

VECTORS(Map);
IN_BUFFER(Ends, uint);
// gather::Gathered of an element, as devices leave it.
struct Gathered {
  vec3 sum;
  float sum_luminance2, first_less_second;
};
BUFFER(AllGathered, Gathered);
// Per element, the first round that counts, and in the second byte the last one that added rays.
IN_BUFFER(CountedRounds, uint);

PUSH(SweepPush) {
  REF(Map) map;  // gather::RadiosityMap
  REF(AllGathered) gathered;
  REF(CountedRounds) counted;
  // The round has these:
  REF(StoredHits) more;  // of all elements, one element's after another's
  REF(Ends) ends;        // per element, one past the last of `more`
  // The chunk has these:
  REF(RaySlots) slots;
  REF(TileRows) rows;
  REF(StoredHits) hits;
  uint slot_count;
  uint map_stride;
  uint round;
  uint first_group;
};

SHARED_END
#endif
