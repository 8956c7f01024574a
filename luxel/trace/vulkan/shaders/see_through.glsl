// How much of a ray's light a surface stops: see_through.h has the structs, scene::passage_at() the
// rules. Numbers by chance are those of the processor's rays, bit for bit.
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "luxel/base/both_sobol.h"

struct Picture {
  uint first, width, height, wrap_u, wrap_v, nearest;
};
struct SeeThroughMaterial {
  uint mode;
  float alpha, cutoff, transmission, metallic;
  Picture base, metal, glass;
};
struct SeeThroughTriangle {
  uint instance, triangle, material;
  uint placed;  // bits 0 to 2: base, metal, glass
  vec2 base[3], metal[3], glass[3];
};
layout(buffer_reference, scalar) readonly buffer SeeThroughMaterials { SeeThroughMaterial at[]; };
layout(buffer_reference, scalar) readonly buffer SeeThroughTriangles { SeeThroughTriangle at[]; };
layout(buffer_reference, scalar) readonly buffer Texels { uint at[]; };

struct SeeThrough {
  SeeThroughMaterials materials;
  SeeThroughTriangles triangles;
  Texels texels;
};

const uint kClamp = 1, kMirror = 2;  // scene::Wrap
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

int wrapped(int i, int n, uint wrap) {
  if (wrap == kClamp) return clamp(i, 0, n - 1);
  int period = wrap == kMirror ? 2 * n : n;
  // The remainder of negative numbers is undefined.
  int j = i >= 0 ? i % period : period - 1 - (-1 - i) % period;
  return j < n ? j : period - 1 - j;
}

float channel_of(Texels texels, Picture p, int x, int y, int channel) {
  uint at = p.first + uint(wrapped(y, int(p.height), p.wrap_v)) * p.width +
            uint(wrapped(x, int(p.width), p.wrap_u));
  return float(bitfieldExtract(texels.at[at], 8 * channel, 8)) / 255.0;
}

// A channel of a picture, between the places of a triangle's corners; 1 without picture or places.
float picture_at(Texels texels, Picture p, bool has_places, vec2 places[3], vec2 uv, int channel) {
  if (p.width == 0 || !has_places) return 1;
  vec2 at = (1 - uv.x - uv.y) * places[0] + uv.x * places[1] + uv.y * places[2];
  at = mix(clamp(at, vec2(-1e6), vec2(1e6)), vec2(0), bvec2(isnan(at.x) || isinf(at.x), isnan(at.y) || isinf(at.y)));
  at *= vec2(p.width, p.height);
  if (p.nearest != 0) return channel_of(texels, p, int(floor(at.x)), int(floor(at.y)), channel);
  vec2 low = floor(at - 0.5), f = at - 0.5 - low;
  ivec2 c = ivec2(low);
  return mix(mix(channel_of(texels, p, c.x, c.y, channel), channel_of(texels, p, c.x + 1, c.y, channel), f.x),
             mix(channel_of(texels, p, c.x, c.y + 1, channel),
                 channel_of(texels, p, c.x + 1, c.y + 1, channel), f.x), f.y);
}

// The share of light that does not go straight through.
float coverage_at(SeeThrough s, uint number, vec2 uv) {
  SeeThroughTriangle t = s.triangles.at[number];
  SeeThroughMaterial m = s.materials.at[t.material];
  float alpha = picture_at(s.texels, m.base, (t.placed & 1u) != 0, t.base, uv, 3) * m.alpha;
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

// Whether the surface lets this ray through.
bool lets_through(SeeThrough s, uint number, vec2 uv, vec3 origin, vec3 direction) {
  float coverage = coverage_at(s, number, uv);
  if (coverage >= 1) return false;
  SeeThroughTriangle t = s.triangles.at[number];
  return chance_of(origin, direction, t.instance, t.triangle) >= coverage;
}
