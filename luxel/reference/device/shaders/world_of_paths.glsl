// Everything that paths look at.
#include "luxel/base/both_directions.h"
#include "luxel/base/both_sobol.h"
#include "luxel/reference/device/paths_shared.h"
#include "luxel/trace/vulkan/shaders/frame.glsl"

const float kPi = 3.14159265358979323846;
#define kInfinity uintBitsToFloat(0x7f800000u)

const uint kPoint = 0, kSpot = 1, kDirectional = 2;  // scene::PunctualLight::Kind

// A side of a surface that a ray has met.
struct Side {
  uint number;
  vec2 uv;
  bool back;
};

// What has two sides is met on the side that the ray comes from: trace::DeviceRayTracer::hit_of().
Side side_of(PathSetup setup, Hit hit) {
  Side s = Side(hit.number & ~kBackFace, vec2(hit.u, hit.v), (hit.number & kBackFace) != 0);
  uint other = setup.triangles.at[s.number].other_side;
  if (s.back && other != kNoTriangle) s = Side(other, s.uv.yx, false);
  return s;
}

float largest(vec3 c) { return max(c.x, max(c.y, c.z)); }

vec3 between(vec3 values[3], vec2 uv) { return values[0] * (1 - uv.x - uv.y) + values[1] * uv.x + values[2] * uv.y; }

// scene::base_color_at()
vec4 base_color_at(PathSetup setup, PathTriangle t, PathMaterial m, vec2 uv) {
  vec4 c = colour_at(setup.texels, setup.linear_of_byte, m.base, (t.flags & kBasePlaced) != 0, t.base, uv);
  return vec4(c.xyz * (m.base_color * between(t.color, uv)), c.w * (m.alpha * alpha_between(t.alpha, uv)));
}

// scene::reflectance_at(), of what scatters no light through.
vec3 reflectance_at(PathSetup setup, PathTriangle t, PathMaterial m, vec2 uv) {
  float metal = m.metallic * picture_at(setup.texels, m.metal, (t.flags & kMetalPlaced) != 0, t.metal, uv, 2);
  return clamp(base_color_at(setup, t, m, uv).xyz * (1 - clamp(metal, 0.0, 1.0)), vec3(0), vec3(0.99));
}

vec3 emission_at(PathSetup setup, PathTriangle t, PathMaterial m, vec2 uv) {
  if (largest(m.emission) <= 0) return vec3(0);
  return m.emission * colour_at(setup.texels, setup.linear_of_byte, m.emission_picture, (t.flags & kEmissionPlaced) != 0, t.emission, uv).xyz;
}

// scene::passage_at(), of masks alone.
float coverage_at(PathSetup setup, PathTriangle t, PathMaterial m, vec2 uv) {
  return (m.flags & kMasked) != 0 && base_color_at(setup, t, m, uv).w < m.cutoff ? 0.0 : 1.0;
}

// reference::Receiver
struct Place {
  vec3 position, normal, geometric_normal;
};

vec3 shading_normal(PathTriangle t, vec2 uv) {
  vec3 n = between(t.normal, uv);
  float l = length(n);
  if (l > 0) n *= 1 / l;
  float side = dot(n, t.front);
  if (abs(side) < 1e-3) return t.front;
  return side < 0 ? -n : n;
}

// On the surface.
Place place_on(PathTriangle t, vec2 uv, bool back) {
  vec3 at = between(t.corner, uv);
  if ((t.flags & kCurved) == 0) return Place(at, back ? -t.front : t.front, back ? -t.front : t.front);
  vec3 n = shading_normal(t, uv);
  if (back) return Place(at, -n, -t.front);
  if ((t.flags & kBends) == 0) return Place(at, n, t.front);
  float weights[3] = float[3](1 - uv.x - uv.y, uv.x, uv.y);
  vec3 lift = vec3(0);
  for (int k = 0; k < 3; ++k) {
    vec3 own = normalize(t.normal[k]);
    lift += own * (weights[k] * max(0.0, dot(t.corner[k] - at, own)));
  }
  // transport::smooth_point() has the reasons for these numbers.
  float limit = 0.25 * t.size_m, height = length(lift);
  if (height > limit) lift *= limit / height;
  return Place(at + lift, n, length(lift) > 1e-4 * t.size_m ? n : t.front);
}

// reference::receiver_at()
Place place_at(PathTriangle t, vec2 uv, bool back) {
  Place p = place_on(t, uv, back);
  p.position = off_surface(p.position, p.geometric_normal, t.size_for_rounding_m);
  return p;
}

// A RandomStream.
struct Random {
  uvec2 seed;
  uint index;
};
float next_float(inout Random r) { return unit_float(hash64(r.seed, uvec2(r.index++, 0)).y); }
vec2 next_vec2(inout Random r) {
  uvec2 bits = hash64(r.seed, uvec2(r.index++, 0));
  return vec2(unit_float(bits.y), unit_float(bits.x));
}
// [0, 1) with 48 bits.
double next_fine(inout Random r) {
  vec2 u = next_vec2(r);
  return double(u.x) + double(u.y) * double(5.9604644775390625e-8);
}
