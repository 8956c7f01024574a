// Makes the rays of elements, traces them, and stores where they land. A work group has one cell of
// directions of 64 elements, whose rays are alike: its threads each take an element, and its rays of
// that cell. ../landed_rays.h has the structs.
#include "element_rays.glsl"
#include "landings.glsl"
layout(local_size_x = 64) in;

// A ray whose end the processor finds.
struct OpenRay {
  uint element, place, sample_number;
  Hit hit;
};
layout(buffer_reference, scalar) buffer OpenRays {
  uint count;  // may be more than there is room for
  uint capacity;
  OpenRay at[];
};
// Per element of the chunk: rays that left the scene, met the back of a one-sided surface, and that
// of another.
struct Counts {
  uint escaped, dark_back, lit_back;
};
layout(buffer_reference, scalar) buffer AllCounts { Counts at[]; };

layout(buffer_reference, scalar) buffer Setup {
  World world;
  Elements elements;
  PlainCells plain;
  Landings landings;
  Words mixed;  // bits per LookupPlace::base: where walls are
  AllCounts counts;
  OpenRays open;
  uvec2 seed;  // of all elements
  uint element_count, samples;
  uint resolution;
  uint has_mixed;
};

layout(push_constant, scalar) uniform Push {
  Setup setup;
  StoredHits hits;  // of the chunk's elements; of 64: the first ray of each, the second of each and so on
  uint first_tile;  // of the chunk: 64 elements each
  uint first_group;  // of this piece of the chunk
};

bool is_mixed(uint base) { return setup.has_mixed != 0 && (setup.mixed.at[base / 32] >> (base % 32) & 1u) != 0; }

void leave_open(uint element, uint place, uint sample_number, Hit hit) {
  uint at = atomicAdd(setup.open.count, 1);
  if (at < setup.open.capacity) setup.open.at[at] = OpenRay(element, place, sample_number, hit);
}

// Where a ray lands. What the processor takes on is counted there.
uvec2 end_of(uint element, uint place, uint sample_number, Hit hit, inout Counts counts) {
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
    leave_open(element, place, sample_number, hit);
    return uvec2(kLeftOpen, 0);
  }
  if ((landing.kind & kFromBehind) != 0) ++counts.lit_back;
  return store(at, 2 * sample_number >= setup.samples);
}

void main() {
  uint group = first_group + gl_WorkGroupID.x, lane = gl_LocalInvocationID.x;
  uint cell = group % kCells, tile = group / kCells, own = tile * 64 + lane, i = first_tile * 64 + own;
  if (i >= setup.element_count) return;
  Element e = setup.elements.at[i];
  uint samples = setup.samples;
  uvec2 own_seed = hash64(setup.seed, uvec2(i, 0));
  uint plain_x = plain_eighths(own_seed.x), plain_y = plain_eighths(own_seed.y);
  uint place = first_place(setup.plain, cell, samples, plain_x, plain_y);
  uint p = plain_cell(cell, plain_x, plain_y);
  Counts counts = Counts(0, 0, 0);
  for (uint k = setup.plain.first_of[p]; k < setup.plain.first_of[p + 1]; ++k, ++place) {
    uint sample_number = setup.plain.sample_of[k];
    Ray ray = Ray(e.origin, ray_direction(e, sample_number, own_seed), 0, uintBitsToFloat(0x7f800000u));
    Hit hit = trace(setup.world, ray, false);
    hits.at[(tile * samples + place) * 64 + lane] = end_of(i, place, sample_number, hit, counts);
  }
  // Whole numbers: their sum is the same in any order.
  if (counts.escaped > 0) atomicAdd(setup.counts.at[own].escaped, counts.escaped);
  if (counts.dark_back > 0) atomicAdd(setup.counts.at[own].dark_back, counts.dark_back);
  if (counts.lit_back > 0) atomicAdd(setup.counts.at[own].lit_back, counts.lit_back);
}
