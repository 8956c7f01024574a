// The rays of a round, and where they land in the lightmap. C++ and GLSL.
#ifndef LUXEL_SOLVE_DEVICE_LAND_SHARED_H
#define LUXEL_SOLVE_DEVICE_LAND_SHARED_H
#include "luxel/solve/device/rays_shared.h"
#include "luxel/trace/vulkan/world_shared.h"
SHARED_BEGIN

// One side of a drawn triangle.
struct Landing {
  ARRAY(vec2, 3) corners;  // in the lightmap [texels]: atlas::Atlas::corners
  float near_m;            // rays that end nearer are followed on (gather::near_paths.h)
  uint kind;               // of the bits below
};
const uint kDark = 1;          // the back of a one-sided surface
const uint kFollowed = 2;      // rays are followed on, however far it is
const uint kFromBehind = 4;    // the back of a surface that sends light there
IN_BUFFER(Landings, Landing);  // two a triangle
IN_BUFFER(Words, uint);

// A ray whose end the processor finds.
struct OpenRay {
  uint element, place, sample_number, doublings;
  Hit hit;
};
BLOCK(OpenRays) {
  uint count;  // may be more than there is room for
  uint capacity;
  REST(OpenRay, at);
};

// Per slot: its rays, and those that left the scene, met the back of a one-sided surface, and that
// of another.
struct EndCounts {
  uint rays, escaped, dark_back, lit_back;
};
BUFFER(AllCounts, EndCounts);

BLOCK(LandSetup) {
  World world;
  REF(Elements) elements;
  REF(Landings) landings;
  REF(Words) mixed;  // bits per LookupPlace::base: where walls are
  REF(AllShares) shares;
  // The chunk has these:
  REF(RaySlots) slots;
  REF(TileRows) rows;
  REF(AllCounts) counts;
  REF(OpenRays) open;
  RaySeeds seeds;
  uint slot_count;
  uint resolution;
  uint has_mixed;
};

PUSH(LandPush) {
  REF(LandSetup) setup;
  REF(StoredHits) hits;  // of the chunk
  uint first_group;      // of this piece of the chunk
};

SHARED_END
#endif
