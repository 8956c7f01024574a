// What the shaders of techniques share: luxel/view/draw/technique_drawing.cpp has the structs.
#include "scene.glsl"

// view::SurfaceCorner
struct Corner {
  vec3 position, normal;
  vec2 uv0, uv1;
  vec3 color;
  float clear;
  uint element, item;
};
struct Element {
  vec3 irradiance, reflectance;
};
struct Phong {
  vec3 specular;
  float sharpness;
};
layout(buffer_reference, scalar) readonly buffer Corners { Corner at[]; };
layout(buffer_reference, scalar) readonly buffer Elements { Element at[]; };
layout(buffer_reference, scalar) readonly buffer Highlights { Phong at[]; };
// Who looks, and the one light of local illumination.
layout(buffer_reference, scalar) readonly buffer Looking {
  vec3 eye;
  uint is_parallel;
  vec3 back;  // against the view
  vec3 ambient, light, to_light;
};

layout(push_constant, scalar) uniform Push {
  mat4 clip_from_world;
  Corners corners;
  Elements elements;
  Highlights highlights;
  Materials materials;
  Looking looking;
  uint material, technique;
  float exposure;
};

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
