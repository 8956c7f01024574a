// The rays of a slot.
#include "element_rays.glsl"

uint doublings_of(AllShares all, uint shares, uint cell) {
  return shares == 0 ? 0 : all.at[(shares - 1) * 8 + cell / 8] >> (cell % 8 * 4) & 15u;
}

// Where the rays of a cell begin among the slot's.
uint first_place(RaySlot s, AllShares all, uint cell, uvec2 plain) {
  if (s.shares == 0) return first_of_cell(cell, s.first, s.end, plain);
  uint count = 0;
  for (uint c = 0; c < cell; ++c) {
    uint d = doublings_of(all, s.shares, c);
    uvec2 place = plain_place(c, plain);
    count += samples_below(s.end << d, place) - samples_below(s.first << d, place);
  }
  return count;
}

uvec2 seed_of_slot(RaySlot s, RaySeeds seeds) {
  return hash64(s.shares == 0 ? seeds.plain : seeds.guided, uvec2(s.element, 0));
}
