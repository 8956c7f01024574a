// Rays through a binary hierarchy: binary_hierarchy.h has the structs.
#include "ray.glsl"

const uint kLeaf = 1u << 31;

// Where the ray is in a box, from x to y; x > y: nowhere. The far end is widened by the roundings
// of the three steps before, so that no box of a triangle that is met is missed [Ize13].
vec2 span_in_box(vec3 lower, vec3 upper, vec3 origin, vec3 inverse, float t_min, float t_max) {
  vec3 a = (lower - origin) * inverse, b = (upper - origin) * inverse;
  vec3 near = min(a, b), far = max(a, b);
  return vec2(max(max(near.x, near.y), max(near.z, t_min)),
              min(min(min(far.x, far.y), far.z) * kWider, t_max));
}

// What is on the stack for an instance that is still to be entered.
const uint kInstance = kLeaf | 7u << 28;

// The first triangle along the ray; with `any`, whichever is found first.
Hit trace(World world, Ray ray, bool any) {
  Hit hit = Hit(ray.t_max, 0, 0, kNoTriangle);
  Space space = world_space(ray);
  vec3 inverse = reciprocal(space.direction);
  uint stack[kMaxDepth];
  uint height = 0, entered_at = 0;  // how high the stack was when the mesh was entered
  uint ref = 0;
  for (;;) {
    if ((ref & kLeaf) == 0) {
      vec4 n0 = world.nodes.at[4 * ref], n1 = world.nodes.at[4 * ref + 1], n2 = world.nodes.at[4 * ref + 2],
           n3 = world.nodes.at[4 * ref + 3];
      vec2 s0 = span_in_box(n0.xyz, n1.xyz, space.origin, inverse, ray.t_min, hit.t);
      vec2 s1 = span_in_box(n2.xyz, n3.xyz, space.origin, inverse, ray.t_min, hit.t);
      uint first = floatBitsToUint(n0.w), second = floatBitsToUint(n1.w);
      bool in0 = s0.x <= s0.y, in1 = s1.x <= s1.y;
      if (in0 && in1) {
        bool swap = s1.x < s0.x;
        stack[height++] = swap ? first : second;
        ref = swap ? second : first;
        continue;
      }
      if (in0 || in1) {
        ref = in0 ? first : second;
        continue;
      }
    } else if (kHasInstances && (ref & kInstance) == kInstance) {
      entered_at = height;
      space = instance_space(world, ref & 0x0fffffffu, ray, ref);
      inverse = reciprocal(space.direction);
      continue;
    } else {
      uint begin = ref & 0x0fffffffu, end = begin + (ref >> 28 & 7u);
      for (uint k = begin; k < end; ++k)
        if (stands_for_instance(world, k))
          stack[height++] = kInstance | k;
        else if (meets(world, k, ray, space, hit) && any)
          return hit;
    }
    if (kHasInstances && space.shared_by != kNotShared && height == entered_at) {
      space = world_space(ray);
      inverse = reciprocal(space.direction);
    }
    if (height == 0) return hit;
    ref = stack[--height];
  }
}
