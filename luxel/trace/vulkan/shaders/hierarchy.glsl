// Rays through a binary hierarchy: binary_hierarchy.h has the structs.
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_scalar_block_layout : require

const uint kLeaf = 1u << 31;
const uint kNoTriangle = 0xffffffffu;
const uint kBackFace = 1u << 31;
const int kMaxDepth = 64;

// Four vectors a node, three a triangle, two a ray: origin and t_min, direction and t_max.
layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer Vectors { vec4 at[]; };

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

// Where the ray is in a box, from x to y; x > y: nowhere. The far end is widened by the roundings
// of the three steps before, so that no box of a triangle that is met is missed [Ize13].
vec2 span_in_box(vec3 lower, vec3 upper, vec3 origin, vec3 inverse, float t_min, float t_max) {
  vec3 a = (lower - origin) * inverse, b = (upper - origin) * inverse;
  vec3 near = min(a, b), far = max(a, b);
  return vec2(max(max(near.x, near.y), max(near.z, t_min)),
              min(min(min(far.x, far.y), far.z) * 1.0000004, t_max));
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
bool meets(Vectors triangles, uint k, Ray ray, inout Hit hit) {
  vec4 a = triangles.at[3 * k], b = triangles.at[3 * k + 1], c = triangles.at[3 * k + 2];
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
  hit = Hit(t, clamp(u / sum, 0.0, 1.0), clamp(v / sum, 0.0, 1.0),
            floatBitsToUint(a.w) | (from_behind ? kBackFace : 0));
  return true;
}

// The first triangle along the ray; with `any`, whichever is found first.
Hit trace(Vectors nodes, Vectors triangles, Ray ray, bool any) {
  Hit hit = Hit(ray.t_max, 0, 0, kNoTriangle);
  vec3 inverse = reciprocal(ray.direction);
  uint stack[kMaxDepth];
  int height = 0;
  uint ref = 0;
  for (;;) {
    if ((ref & kLeaf) == 0) {
      vec4 n0 = nodes.at[4 * ref], n1 = nodes.at[4 * ref + 1], n2 = nodes.at[4 * ref + 2],
           n3 = nodes.at[4 * ref + 3];
      vec2 s0 = span_in_box(n0.xyz, n1.xyz, ray.origin, inverse, ray.t_min, hit.t);
      vec2 s1 = span_in_box(n2.xyz, n3.xyz, ray.origin, inverse, ray.t_min, hit.t);
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
    } else {
      uint begin = ref & 0x0fffffffu, end = begin + (ref >> 28 & 7u);
      for (uint k = begin; k < end; ++k)
        if (meets(triangles, k, ray, hit) && any) return hit;
    }
    if (height == 0) return hit;
    ref = stack[--height];
  }
}
