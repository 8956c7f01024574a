// Rays through a wide hierarchy: wide_hierarchy.h has the nodes. [Ylitie17, algorithms 1 and 2]
#include "ray.glsl"

// Children that a ray meets. Nodes: bits 24 to 31, the nearest in the highest; the slots that have
// nodes in bits 0 to 7. Triangles: a bit for each, counted from `first`.
struct Group {
  uint first, bits;
};

struct Meeting {
  Group nodes, triangles;
};

float byte_of(uint word, int k) { return float(bitfieldExtract(word, 8 * k, 8)); }

// Bits of the children `4 half` to `4 half + 3` that the ray meets before t_max. `flip`: a byte for
// each child, which turns slots into the order along the ray.
uint meet_half(uint meta, uint flip, uvec3 near, uvec3 far, vec3 unit, vec3 start, float t_min,
               float t_max) {
  uint inner = (meta & (meta << 1)) & 0x10101010u;
  uint place = (meta ^ (flip & (inner >> 4) * 0xffu)) & 0x1f1f1f1fu;
  uint ones = (meta >> 5) & 0x07070707u;
  uint bits = 0;
  for (int k = 0; k < 4; ++k) {
    vec3 a = vec3(byte_of(near.x, k), byte_of(near.y, k), byte_of(near.z, k)) * unit + start;
    vec3 b = vec3(byte_of(far.x, k), byte_of(far.y, k), byte_of(far.z, k)) * unit + start;
    float from = max(max(a.x, a.y), max(a.z, t_min));
    float to = min(min(min(b.x, b.y), b.z) * kWider, t_max);
    if (from <= to)
      bits |= bitfieldExtract(ones, 8 * k, 8) << bitfieldExtract(place, 8 * k, 8);
  }
  return bits;
}

Meeting meet(Vectors nodes, uint index, vec3 origin, vec3 inverse, uint flip, float t_min,
             float t_max) {
  vec4 n0 = nodes.at[5 * index];
  uvec4 n1 = floatBitsToUint(nodes.at[5 * index + 1]), n2 = floatBitsToUint(nodes.at[5 * index + 2]),
        n3 = floatBitsToUint(nodes.at[5 * index + 3]), n4 = floatBitsToUint(nodes.at[5 * index + 4]);
  uint packed = floatBitsToUint(n0.w);
  vec3 unit = uintBitsToFloat(uvec3(packed & 0xffu, packed >> 8 & 0xffu, packed >> 16 & 0xffu) << 23) *
              inverse;
  vec3 start = (n0.xyz - origin) * inverse;
  bvec3 back = lessThan(inverse, vec3(0));
  // Lower and upper sides of children 0 to 3 and 4 to 7.
  uvec3 low0 = uvec3(n2.x, n2.z, n3.x), low1 = uvec3(n2.y, n2.w, n3.y),
        high0 = uvec3(n3.z, n4.x, n4.z), high1 = uvec3(n3.w, n4.y, n4.w);
  uint bits = meet_half(n1.z, flip, mix(low0, high0, back), mix(high0, low0, back), unit, start,
                        t_min, t_max) |
              meet_half(n1.w, flip, mix(low1, high1, back), mix(high1, low1, back), unit, start,
                        t_min, t_max);
  return Meeting(Group(n1.x, (bits & 0xff000000u) | packed >> 24), Group(n1.y, bits & 0x00ffffffu));
}

// How a ray goes through boxes.
struct Way {
  vec3 inverse;
  uint slot_flip, flip;
};
Way way_of(Space s) {
  vec3 inverse = reciprocal(s.direction);
  // A ray towards +x meets the slots without bit 2 first, and so on.
  uint slot_flip = (inverse.x < 0 ? 0u : 4u) | (inverse.y < 0 ? 0u : 2u) | (inverse.z < 0 ? 0u : 1u);
  return Way(inverse, slot_flip, slot_flip * 0x01010101u);
}

// The first triangle along the ray; with `any`, whichever is found first.
Hit trace(World world, Ray ray, bool any) {
  Hit hit = Hit(ray.t_max, 0, 0, kNoTriangle);
  Space space = world_space(ray);
  Way way = way_of(space);
  Group stack[kMaxDepth];
  uint height = 0, entered_at = 0;  // how high the stack was when the mesh was entered
  uint node = 0;                    // whose children are looked at next
  for (;;) {
    Meeting now = meet(world.nodes, node, space.origin, way.inverse, way.flip, ray.t_min, hit.t);
    for (;;) {
      bool enters = false;
      while (now.triangles.bits != 0 && !enters) {
        int k = findMSB(now.triangles.bits);
        now.triangles.bits &= ~(1u << k);
        uint triangle = now.triangles.first + uint(k);
        if (stands_for_instance(world, triangle)) {
          if (now.nodes.bits > 0x00ffffffu) stack[height++] = now.nodes;
          if (now.triangles.bits != 0) stack[height++] = now.triangles;
          entered_at = height, enters = true;
          space = instance_space(world, triangle, ray, node);
          way = way_of(space);
        } else if (meets(world, triangle, ray, space, hit) && any) {
          return hit;
        }
      }
      if (enters) break;
      if (now.nodes.bits <= 0x00ffffffu) {
        if (kHasInstances && space.shared_by != kNotShared && height == entered_at) {
          space = world_space(ray);
          way = way_of(space);
        }
        if (height == 0) return hit;
        Group next = stack[--height];
        now.nodes = next;
        if (kHasInstances && next.bits <= 0x00ffffffu) {
          now.triangles = next, now.nodes.bits = 0;
          continue;
        }
      }
      int k = findMSB(now.nodes.bits);
      uint inner = now.nodes.bits & 0xffu;
      now.nodes.bits &= ~(1u << k);
      if (now.nodes.bits > 0x00ffffffu) stack[height++] = now.nodes;
      uint slot = (uint(k) - 24u) ^ way.slot_flip;
      node = now.nodes.first + bitCount(inner & ~(0xffffffffu << slot));
      break;
    }
  }
}
