// What the rays of a camera's samples meet first, when the backs of one-sided surfaces are
// invisible: trace::visible_hits().
#version 460
#extension GL_GOOGLE_include_directive : require
#include "luxel/trace/vulkan/shaders/hierarchy.glsl"
#include "world_of_paths.glsl"
#include "camera.glsl"
layout(local_size_x = kPathThreads) in;

OUT_BUFFER(Hits, Hit);
#include "luxel/reference/device/eye_push_shared.h"

const int kMostSurfaces = 64;

void main() {
  uint item = (first_group + gl_WorkGroupID.x) * kPathThreads + gl_LocalInvocationID.x;
  if (item >= item_count) return;
  uint pixel = first_pixel + item / slices, own_sample = item % slices * samples_of_slice + first_sample;
  Hit hit = Hit(kInfinity, 0, 0, kNoTriangle);
  if (own_sample < samples) {
    Random random;
    Ray ray = ray_of_pixel(camera, pixel, own_sample, seed, random);
    for (int k = 0; k < kMostSurfaces; ++k) {
      hit = trace(setup.world, ray, false);
      if (hit.number == kNoTriangle) break;
      Side side = side_of(setup, hit);
      if (!side.back || (setup.materials.at[setup.triangles.at[side.number].material].flags & kDoubleSided) != 0) break;
      ray.t_min = max(hit.t * (1 + 4e-7), 1e-20);
      hit = Hit(kInfinity, 0, 0, kNoTriangle);
    }
  }
  hits.at[item] = hit;
}
