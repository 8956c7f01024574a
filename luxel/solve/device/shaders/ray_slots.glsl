// The rays that a round adds to elements: ../ray_slots.h.
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_scalar_block_layout : require
struct RaySlot {
  uint element;
  uint first, end;  // its samples
  uint shares;      // 0: each cell has as many as the others; else 1 + a number of AllShares
  uint places;      // for hits
};
layout(buffer_reference, scalar) readonly buffer RaySlots { RaySlot at[]; };
// gather::CellShares, four bits for each cell.
layout(buffer_reference, scalar) readonly buffer AllShares { uint at[]; };
// Per tile of 64 slots, where its hits begin: the first of each slot, the second of each and so on.
layout(buffer_reference, scalar) readonly buffer TileRows { uint at[]; };
