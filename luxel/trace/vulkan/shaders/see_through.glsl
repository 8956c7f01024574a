// How much of a ray's light a surface stops: scene::passage_at() has the rules. Numbers by chance are
// those of the processor's rays, bit for bit.
#extension GL_GOOGLE_include_directive : require
#include "luxel/base/both_sobol.h"
#include "luxel/trace/vulkan/shaders/pictures.glsl"

const uint kMask = 1, kBlend = 2;    // scene::AlphaMode

// 64-bit numbers as pairs, the lower half in x: not every device has them.
uvec2 add64(uvec2 a, uvec2 b) {
  uint carry;
  uint low = uaddCarry(a.x, b.x, carry);
  return uvec2(low, a.y + b.y + carry);
}
uvec2 multiply64(uvec2 a, uvec2 b) {
  uint high, low;
  umulExtended(a.x, b.x, high, low);
  return uvec2(low, high + a.x * b.y + a.y * b.x);
}
// x ^ (x >> bits), 0 < bits < 32
uvec2 mixed64(uvec2 x, int bits) {
  return x ^ uvec2(x.x >> bits | x.y << (32 - bits), x.y >> bits);
}
// luxel/base/random.h
uvec2 hash64(uvec2 x) {
  x = add64(x, uvec2(0x7f4a7c15u, 0x9e3779b9u));
  x = multiply64(mixed64(x, 30), uvec2(0x1ce4e5b9u, 0xbf58476du));
  x = multiply64(mixed64(x, 27), uvec2(0x133111ebu, 0x94d049bbu));
  return mixed64(x, 31);
}
uvec2 hash64(uvec2 a, uvec2 b) { return hash64(hash64(a) ^ b); }

// A number in [0, 1) that follows from the bits of a ray and of what it meets.
float chance_of(vec3 origin, vec3 direction, uint instance, uint triangle) {
  uvec3 o = floatBitsToUint(origin), d = floatBitsToUint(direction);
  uvec2 towards = hash64(uvec2(d.y, d.x), uvec2(d.z, 0)), from = hash64(uvec2(o.y, o.x), uvec2(o.z, 0));
  return unit_float(hash64(hash64(towards, from), uvec2(triangle, instance)).y);
}

// The share of light that does not go straight through.
float coverage_at(SeeThrough s, uint number, vec2 uv) {
  SeeThroughTriangle t = s.triangles.at[number];
  SeeThroughMaterial m = s.materials.at[t.material];
  float alpha = picture_at(s.texels, m.base, (t.placed & 1u) != 0, t.base, uv, 3) * (m.alpha * alpha_between(t.alpha, uv));
  if (m.mode == kMask && alpha < m.cutoff) return 0;
  float coverage = m.mode == kBlend ? clamp(alpha, 0.0, 1.0) : 1.0;
  if (m.transmission > 0) {
    float metal = clamp(m.metallic * picture_at(s.texels, m.metal, (t.placed & 2u) != 0, t.metal, uv, 2), 0.0, 1.0);
    float through = m.transmission * (1 - metal) * picture_at(s.texels, m.glass, (t.placed & 4u) != 0, t.glass, uv, 0);
    float open = 1 - coverage, glass = coverage * clamp(through, 0.0, 1.0);
    coverage = 1 - open - glass;
  }
  return coverage;
}

// Whether the surface lets this ray through. `shared_by`: the instance of a shared mesh that is met;
// kNotShared: the triangle has one of its own.
const uint kNotShared = 0xffffffffu;
bool lets_through(SeeThrough s, uint number, uint shared_by, vec2 uv, vec3 origin, vec3 direction) {
  float coverage = coverage_at(s, number, uv);
  if (coverage >= 1) return false;
  SeeThroughTriangle t = s.triangles.at[number];
  uint instance = shared_by == kNotShared ? t.instance : shared_by;
  return chance_of(origin, direction, instance, t.triangle) >= coverage;
}
