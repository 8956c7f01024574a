// Rays, triangles and what rays meet of them.
#extension GL_GOOGLE_include_directive : require
#include "see_through.glsl"

layout(constant_id = 0) const bool kSomeLetLightThrough = true;

// What the far end of a box is widened by, so that rounding misses none that a ray meets [Ize13].
// The reciprocal may be off by 2.5 units in the last place, as Vulkan allows.
const float kWider = 1.000001;

const uint kNoTriangle = 0xffffffffu;
const uint kBackFace = 1u << 31;
const int kMaxDepth = 64;

// Three vectors a triangle (binary_hierarchy.h), two a ray: origin and t_min, direction and t_max.
layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer Vectors { vec4 at[]; };

// What rays are traced through.
struct World {
  Vectors nodes, triangles;
  SeeThrough see_through;
};

struct Ray {
  vec3 origin, direction;
  float t_min, t_max;
};

struct Hit {
  float t, u, v;
  uint number;  // of the triangle, kBackFace added where it is met from behind; or kNoTriangle
};

Ray ray_at(Vectors rays, uint i) {
  vec4 a = rays.at[2 * i], b = rays.at[2 * i + 1];
  return Ray(a.xyz, b.xyz, a.w, b.w);
}

// 1 / direction, finite: a component of no size becomes a tiny one, which moves the ray by less than
// any rounding.
vec3 reciprocal(vec3 direction) {
  vec3 tiny = mix(vec3(1e-20), vec3(-1e-20), lessThan(direction, vec3(0)));
  return 1 / mix(direction, tiny, lessThan(abs(direction), vec3(1e-20)));
}

// Twice the signed volume of the ray and the edge from p to q, both seen from the origin. Seen from
// the triangle on the other side of the edge it is the same number with the other sign, for sums
// and differences are: no ray slips through between the two.
precise float side_of_edge(vec3 p, vec3 q, vec3 direction) {
  precise vec3 along = q - p, twice = q + p;
  precise vec3 c = vec3(along.y * twice.z - along.z * twice.y, along.z * twice.x - along.x * twice.z,
                        along.x * twice.y - along.y * twice.x);
  precise float side = c.x * direction.x + c.y * direction.y + c.z * direction.z;
  return side;
}

// Puts what the ray meets of a triangle into `hit` if that lies before hit.t, and says so.
bool meets(World world, uint k, Ray ray, inout Hit hit) {
  vec4 a = world.triangles.at[3 * k], b = world.triangles.at[3 * k + 1],
       c = world.triangles.at[3 * k + 2];
  vec3 p = a.xyz - ray.origin, q = b.xyz - ray.origin, r = c.xyz - ray.origin;
  float u = side_of_edge(p, r, ray.direction), v = side_of_edge(q, p, ray.direction),
        w = side_of_edge(r, q, ray.direction);
  float sum = u + v + w, slack = 1.1920929e-7 * abs(sum);
  if (min(min(u, v), w) < -slack && max(max(u, v), w) > slack) return false;
  vec3 normal = cross(r - p, p - q);
  float slope = dot(normal, ray.direction);
  float t = dot(normal, p) / slope;
  if (slope == 0 || sum == 0 || !(t >= ray.t_min && t <= hit.t)) return false;
  bool from_behind = (slope > 0) != (floatBitsToUint(b.w) != 0);
  vec2 uv = clamp(vec2(u, v) / sum, 0.0, 1.0);
  uint open = floatBitsToUint(c.w);
  if (kSomeLetLightThrough && open != 0 &&
      lets_through(world.see_through, open - 1, uv, ray.origin, ray.direction))
    return false;
  hit = Hit(t, uv.x, uv.y, floatBitsToUint(a.w) | (from_behind ? kBackFace : 0));
  return true;
}
