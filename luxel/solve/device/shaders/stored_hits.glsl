// Where rays land in the lightmap, in eight bytes: luxel/solve/gather/rays/hit_store.h, and landings.h
// beside this folder.

// The lower half of gather::StoredHit's bits in x. What lands nowhere reads no texel (its base and
// both fractions are 0), and has one of these numbers where others have their tint.
const uint kEscaped = 1, kMetDarkBack = 2, kLeftOpen = 3;

const float kSteps = 1023;
const uint kNoTint = 2047, kSecondHalf = 1u << 11;

// transport::LookupPlace
struct LookupPlace {
  uint base;
  vec2 f;
};

uvec2 store(LookupPlace p, bool second_half, uint doublings) {
  uvec2 f = uvec2(p.f * kSteps + 0.5);
  return uvec2(f.x << 25 | f.y << 15 | doublings << 12 | (second_half ? kSecondHalf : 0) | kNoTint, p.base << 3 | f.x >> 7);
}

LookupPlace place_of(uvec2 hit) {
  return LookupPlace(hit.y >> 3, vec2((hit.y & 7u) << 7 | hit.x >> 25, hit.x >> 15 & 1023u) * (1 / kSteps));
}

// 2^-doublings
float weight_of(uvec2 hit) { return uintBitsToFloat((127 - (hit.x >> 12 & 7u)) << 23); }

// gather::unpack_tint()
vec3 unpack_tint(uint tint) { return vec3(tint >> 7, tint >> 3 & 15u, tint & 7u) / vec3(15, 15, 7); }
