// Elements, and the rays that a round adds to them. C++ and GLSL.
#ifndef LUXEL_SOLVE_DEVICE_RAYS_SHARED_H
#define LUXEL_SOLVE_DEVICE_RAYS_SHARED_H
#include "luxel/gpu/shared_language.h"
SHARED_BEGIN

// Elements, or slots of rays, whose rays of a cell of directions are traced together, by one work
// group.
const uint kRaysTogether = 64;

struct Element {
  vec3 origin;  // off the surface
  vec3 normal, geometric_normal;
};
IN_BUFFER(Elements, Element);

// The rays that a round adds to one element.
struct RaySlot {
  uint element;
  uint first, end;  // its samples
  uint shares;      // 0: each cell has as many as the others; else 1 + a number of AllShares
  uint places;      // for hits: as many as there are rays, or a few more
};
IN_BUFFER(RaySlots, RaySlot);
// gather::CellShares, four bits for each cell.
IN_BUFFER(AllShares, uint);
// Per tile of slots, where its hits begin: the first of each slot, the second of each and so on.
IN_BUFFER(TileRows, uint);
// gather::StoredHit
BUFFER(StoredHits, uvec2);

// Seeds of all rays: of plain ones, and of those that follow a guide.
struct RaySeeds {
  uvec2 plain, guided;
};

SHARED_END
#endif
