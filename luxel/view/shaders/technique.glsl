// What the shaders of techniques share.
#include "scene.glsl"

// view::SurfaceCorner
struct Corner {
  vec3 position, normal;
  vec2 uv0, uv1;
  vec3 color;
  float clear;
  uint element, item;
};
IN_BUFFER(SurfaceCorners, Corner);
#include "luxel/view/draw/technique_shared.h"

// view::Technique
const uint c = 0, ca = 1, cad = 2, cas = 3, cads = 4, cas_pixel = 5, cads_pixel = 6, normals = 7,
           radiosity_vertex = 8, radiosity = 9, elements_in_colours = 10;

vec3 way_to_viewer(vec3 place) {
  return looking.is_parallel != 0 ? looking.back : normalize(looking.eye - place);
}

// N.L and the highlight (R.V)^n of local illumination. [Rodriguez06, eq. 4.21 to 4.28]
// display::local_color says where the print errs.
vec2 lit_by_light(vec3 normal, vec3 to_viewer, float sharpness) {
  float facing = clamp(dot(normal, looking.to_light), 0, 1);
  if (facing <= 0) return vec2(0);
  vec3 mirrored = normalize(normal * (2 * facing) - looking.to_light);
  float cosine = clamp(dot(mirrored, to_viewer), 0, 1);
  // pow(0, 0) is undefined here.
  return vec2(facing, cosine > 0 ? pow(cosine, sharpness) : (sharpness == 0 ? 1 : 0));
}
