// Rays, triangles and what rays meet of them.
#extension GL_GOOGLE_include_directive : require
#include "see_through.glsl"

// DeviceRayTracer::shader_constant()
layout(constant_id = 0) const uint kWorld = 3;
const bool kSomeLetLightThrough = (kWorld & 1u) != 0, kHasInstances = (kWorld & 2u) != 0;

// What the far end of a box is widened by, so that rounding misses none that a ray meets [Ize13].
// The reciprocal may be off by 2.5 units in the last place, as Vulkan allows.
const float kWider = 1.000001;

const uint kMaxDepth = kHasInstances ? 128 : 64;  // of the world, and of a mesh below it

struct Ray {
  vec3 origin, direction;
  float t_min, t_max;
};

// Where a ray is among triangles: in the world, or in the space of a mesh that instances share.
struct Space {
  vec3 origin, direction;
  uint first_number;  // of the triangles there
  uint shared_by;     // the instance; in the world kNotShared
};
Space world_space(Ray ray) { return Space(ray.origin, ray.direction, 0, kNotShared); }

// The space of an instance of a shared mesh, and the root of the mesh. `k`: what stands for it.
Space instance_space(World world, uint k, Ray ray, out uint root) {
  uint at = 3 * floatBitsToUint(world.triangles.at[3 * k].w);
  vec4 x = world.triangles.at[at], y = world.triangles.at[at + 1], z = world.triangles.at[at + 2];
  uvec4 rest = floatBitsToUint(world.triangles.at[at + 3]);
  root = rest.x;
  vec4 origin = vec4(ray.origin, 1), direction = vec4(ray.direction, 0);
  return Space(vec3(dot(x, origin), dot(y, origin), dot(z, origin)),
               vec3(dot(x, direction), dot(y, direction), dot(z, direction)), rest.y, rest.z);
}
bool stands_for_instance(World world, uint k) {
  return kHasInstances && floatBitsToUint(world.triangles.at[3 * k + 1].w) == 2;
}

Ray ray_at(Vectors rays, uint i) {
  vec4 a = rays.at[2 * i], b = rays.at[2 * i + 1];
  return Ray(a.xyz, b.xyz, a.w, b.w);
}

// A component of no size becomes a tiny one, which moves the ray by less than any rounding.
vec3 without_zeros(vec3 direction) {
  vec3 tiny = mix(vec3(1e-20), vec3(-1e-20), lessThan(direction, vec3(0)));
  return mix(direction, tiny, lessThan(abs(direction), vec3(1e-20)));
}
// 1 / direction, finite.
vec3 reciprocal(vec3 direction) { return 1 / without_zeros(direction); }

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

// Puts what the ray, which is in space s, meets of a triangle into `hit` if that lies before hit.t,
// and says so.
bool meets(World world, uint k, Ray ray, Space s, inout Hit hit) {
  vec4 a = world.triangles.at[3 * k], b = world.triangles.at[3 * k + 1],
       c = world.triangles.at[3 * k + 2];
  vec3 p = a.xyz - s.origin, q = b.xyz - s.origin, r = c.xyz - s.origin;
  float u = side_of_edge(p, r, s.direction), v = side_of_edge(q, p, s.direction),
        w = side_of_edge(r, q, s.direction);
  float sum = u + v + w, slack = 1.1920929e-7 * abs(sum);
  if (min(min(u, v), w) < -slack && max(max(u, v), w) > slack) return false;
  vec3 normal = cross(r - p, p - q);
  float slope = dot(normal, s.direction);
  float t = dot(normal, p) / slope;
  if (slope == 0 || sum == 0 || !(t >= ray.t_min && t <= hit.t)) return false;
  bool from_behind = (slope > 0) != (floatBitsToUint(b.w) != 0);
  vec2 uv = clamp(vec2(u, v) / sum, 0.0, 1.0);
  uint open = floatBitsToUint(c.w);
  if (kSomeLetLightThrough && open != 0 &&
      lets_through(world.see_through, open - 1, s.shared_by, uv, ray.origin, ray.direction))
    return false;
  hit = Hit(t, uv.x, uv.y, (floatBitsToUint(a.w) + s.first_number) | (from_behind ? kBackFace : 0));
  return true;
}
