// Makes the rays of elements, traces them, and stores where they land. A work group has one cell of
// directions of 64 slots, whose rays are alike: its threads each take a slot, and its rays of that
// cell.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "luxel/trace/vulkan/shaders/hierarchy.glsl"
#include "landings.glsl"
#include "slot_rays.glsl"
layout(local_size_x = kRaysTogether) in;

bool is_mixed(uint base) { return setup.has_mixed != 0 && (setup.mixed.at[base / 32] >> (base % 32) & 1u) != 0; }

// A ray of a slot.
struct SlotRay {
  uint place, sample_number, doublings;
};

void leave_open(RaySlot slot, SlotRay ray, Hit hit) {
  uint at = atomicAdd(setup.open.count, 1);
  if (at < setup.open.capacity)
    setup.open.at[at] = OpenRay(slot.element, ray.place, ray.sample_number, ray.doublings, hit);
}

// Where a ray lands. What the processor takes on is counted there.
uvec2 end_of(RaySlot slot, SlotRay ray, Hit hit, inout EndCounts counts) {
  if (hit.number == kNoTriangle) {
    ++counts.escaped;
    return uvec2(kEscaped, 0);
  }
  uint side = (hit.number & kBackFace) != 0 ? 1 : 0;
  Landing landing = setup.landings.at[2 * (hit.number & ~kBackFace) + side];
  if ((landing.kind & kDark) != 0) {
    ++counts.dark_back;
    return uvec2(kMetDarkBack, 0);
  }
  LookupPlace at = lookup_place(landing, vec2(hit.u, hit.v), setup.resolution);
  if ((landing.kind & kFollowed) != 0 || hit.t < landing.near_m || is_mixed(at.base)) {
    leave_open(slot, ray, hit);
    return uvec2(kLeftOpen, 0);
  }
  if ((landing.kind & kFromBehind) != 0) ++counts.lit_back;
  return store(at, 2 * ray.sample_number >= slot.end << ray.doublings, ray.doublings);
}

void main() {
  uint group = first_group + gl_WorkGroupID.x, lane = gl_LocalInvocationID.x;
  uint cell = group % kCells, tile = group / kCells, own = tile * kRaysTogether + lane;
  if (own >= setup.slot_count) return;
  RaySlot slot = setup.slots.at[own];
  Element e = setup.elements.at[slot.element];
  uvec2 seed = seed_of_slot(slot, setup.seeds);
  uvec2 plain = all_plain_eighths(seed), at = plain_place(cell, plain);
  uint doublings = doublings_of(setup.shares, slot.shares, cell);
  uint first = slot.first << doublings, end = slot.end << doublings;
  SlotRay ray = SlotRay(first_place(slot, setup.shares, cell, plain), 0, doublings);
  EndCounts counts = EndCounts(0, 0, 0, 0);
  for (uint block = first / kCells; block * kCells < end; ++block) {
    ray.sample_number = sample_of_eighths(block, at.x, at.y);
    if (ray.sample_number < first || ray.sample_number >= end) continue;
    vec3 direction = ray_direction(e, ray.sample_number, seed);
    Hit hit = trace(setup.world, Ray(e.origin, direction, 0, uintBitsToFloat(0x7f800000u)), false);
    hits.at[(setup.rows.at[tile] + ray.place) * kRaysTogether + lane] = end_of(slot, ray, hit, counts);
    ++ray.place, ++counts.rays;
  }
  // Whole numbers: their sum is the same in any order.
  atomicAdd(setup.counts.at[own].rays, counts.rays);
  if (counts.escaped > 0) atomicAdd(setup.counts.at[own].escaped, counts.escaped);
  if (counts.dark_back > 0) atomicAdd(setup.counts.at[own].dark_back, counts.dark_back);
  if (counts.lit_back > 0) atomicAdd(setup.counts.at[own].lit_back, counts.lit_back);
}
