// What viewpoints see through hemicubes: luxel/solve/hemicube/look.h. A work group takes a
// viewpoint, its threads one pixel after the other; neighbours in the list of pixels look in similar
// directions. Shares are whole numbers, whose sum is the same in any order.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "luxel/trace/vulkan/shaders/hierarchy.glsl"
#include "luxel/solve/device/look_shared.h"
#include "surroundings.glsl"

const uint kThreads = 128;
layout(local_size_x = 128) in;

shared vec3 emitted_by[kThreads];
shared uint back, two_sided_back;

float cross2(vec2 a, vec2 b) { return a.x * b.y - a.y * b.x; }

// hemicube::locate(): the triangle of the mesh that holds a point, and where in it.
uint locate(SeenTriangle t, vec2 x, out vec2 at) {
  uint index = t.first_root;
  if (t.grid > 1) {
    float n = float(t.grid);
    vec2 cell = max(x, vec2(0)) * n;
    uint j = min(uint(cell.y), t.grid - 1), i = min(uint(cell.x), t.grid - 1 - j);
    bool upper = i + j + 1 < t.grid && (cell.x - float(i)) + (cell.y - float(j)) > 1;
    index += j * (2 * t.grid - j) + 2 * i + (upper ? 1 : 0);
  }
  for (uint child; (child = setup.nodes.at[index].child) != 0;) {
    vec2 from_corner = setup.nodes.at[child].at[1], to_corner = setup.nodes.at[child].at[2];
    index = child + (cross2(to_corner - from_corner, x - from_corner) >= 0 ? 0 : 1);
  }
  Node node = setup.nodes.at[index];
  vec2 a = node.at[0], e1 = node.at[1] - a, e2 = node.at[2] - a, d = x - a;
  float area = cross2(e1, e2);
  at.x = clamp(cross2(d, e2) / area, 0.0, 1.0);
  at.y = clamp(cross2(e1, d) / area, 0.0, 1.0 - at.x);
  return index;
}

void add_share(uint view, uint element, uint weight) {
  if (weight > 0) atomicAdd(shares.at[view * setup.element_count + element], weight);
}

// Counts a pixel; returns the irradiance of what shines there.
vec3 see(uint view, Pixel pixel, vec3 direction, Hit hit) {
  float factor = 3.14159265358979323846 * pixel.factor;
  if (hit.number == kNoTriangle) return soft_radiance(setup.around, direction) * factor;
  uint number = hit.number & ~kBackFace;
  bool from_behind = (hit.number & kBackFace) != 0;
  vec2 uv = vec2(hit.u, hit.v);
  SeenTriangle t = setup.triangles.at[number];
  if (from_behind && t.other_side != kNoTriangle) {
    t = setup.triangles.at[t.other_side];
    uv = uv.yx, from_behind = false;
  }
  if (from_behind && (t.flags & kTwoSided) == 0) {
    atomicAdd(back, pixel.weight);
    return vec3(0);
  }
  if (from_behind) atomicAdd(two_sided_back, pixel.weight);
  vec2 at;
  Node node = setup.nodes.at[locate(t, uv, at)];
  if (setup.per_vertex == 0) {
    add_share(view, node.element[0], pixel.weight);
  } else {
    // Sums are rounded, not shares: what rounding takes from one corner the next one gets.
    float whole = float(pixel.weight);
    uint two = min(uint((at.x + at.y) * whole + 0.5), pixel.weight), one = min(uint(at.x * whole + 0.5), two);
    add_share(view, node.element[0], pixel.weight - two);
    add_share(view, node.element[1], one);
    add_share(view, node.element[2], two - one);
  }
  if ((t.flags & kEmissive) == 0) return vec3(0);
  vec3 emission = t.emission;
  if (t.picture != 0)
    emission *= colour_at(setup.texels, setup.linear_of_byte, setup.pictures.at[t.picture - 1], uv);
  return emission * factor;
}

void main() {
  uint view = first_group + gl_WorkGroupID.x, lane = gl_LocalInvocationID.x;
  Viewpoint eye = from.at[view];
  if (lane == 0) back = 0, two_sided_back = 0;
  barrier();
  vec3 emitted = vec3(0);
  for (uint k = lane; k < setup.pixel_count; k += kThreads) {
    Pixel pixel = setup.pixels.at[k];
    vec3 d = eye.tangent * pixel.direction.x + eye.bitangent * pixel.direction.y + eye.normal * pixel.direction.z;
    // Those below the element's own triangle see its back: black.
    if (dot(d, eye.geometric_normal) <= 0) continue;
    Hit hit = trace(setup.world, Ray(eye.origin, d, 0, uintBitsToFloat(0x7f800000u)), false);
    emitted += see(view, pixel, d, hit);
  }
  // In the order of threads: the sum is the same each time.
  emitted_by[lane] = emitted;
  for (uint half_of = kThreads / 2; half_of > 0; half_of /= 2) {
    barrier();
    if (lane < half_of) emitted_by[lane] += emitted_by[lane + half_of];
  }
  barrier();
  if (lane == 0) views.at[view] = View(emitted_by[0], back, two_sided_back);
}
