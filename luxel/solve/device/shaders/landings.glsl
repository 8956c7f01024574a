// Which place of the lightmap a triangle's point has.
#include "luxel/solve/device/land_shared.h"
#include "stored_hits.glsl"

// transport::lookup_place()
LookupPlace lookup_place(Landing l, vec2 uv, uint resolution) {
  vec2 at = l.corners[0] * (1 - uv.x - uv.y) + l.corners[1] * uv.x + l.corners[2] * uv.y;
  at = clamp(at, vec2(0), vec2(resolution)) + 0.5;
  uvec2 low = uvec2(at);
  return LookupPlace(low.y * (resolution + 2) + low.x, at - vec2(low));
}
