#version 460
#extension GL_GOOGLE_include_directive : require
#include "luxel/view/draw/behind_shared.h"

layout(binding = 0) uniform sampler2D map;
layout(location = 0) in vec3 towards;
layout(location = 0) out vec4 seen;

const float pi = 3.14159265358979;
const float most = 60000;

void main() {
  vec3 d = normalize(towards);
  vec2 at = vec2(0.5 + (atan(d.z, d.x) - rotation) / (2 * pi), atan(length(d.xz), d.y) / pi);
  vec3 radiance = background;
  // Without mipmaps there is no seam where the angle jumps.
  if (map_scale != vec3(0)) radiance += textureLod(map, at, 0).rgb * map_scale;
  if (show == 2) radiance = vec3(0);
  seen = vec4(min(radiance * exposure, most), 0);
}
