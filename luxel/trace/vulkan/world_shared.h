// The world that rays are traced through, and what they meet, as devices have it. C++ and GLSL.
#ifndef LUXEL_TRACE_VULKAN_WORLD_SHARED_H
#define LUXEL_TRACE_VULKAN_WORLD_SHARED_H
#include "luxel/gpu/shared_language.h"
SHARED_BEGIN

IN_BUFFER(Texels, uint);  // RGBA, red in the lowest byte
IN_BUFFER(Floats, float);
// Three vectors a triangle (binary_hierarchy.h, device_hierarchy.h), two a ray: origin and t_min,
// direction and t_max.
VECTORS(Vectors);

// A texture in a list of texels, and how it is looked up.
struct Picture {
  uint first;
  uint width, height;   // 0: none, which is 1 everywhere
  uint wrap_u, wrap_v;  // scene::Wrap
  uint nearest;         // 1: not filtered
};

// A picture on a triangle.
struct PlacedPicture {
  Picture picture;
  uint is_placed;         // 1: its mesh has texture coordinates
  ARRAY(vec2, 3) places;  // of the triangle's corners in the picture
};

// scene::Material without what rays do not notice.
struct SeeThroughMaterial {
  uint mode;  // scene::AlphaMode
  float alpha, cutoff, transmission, metallic;
  Picture base, metal, glass;
};
IN_BUFFER(SeeThroughMaterials, SeeThroughMaterial);

// A triangle of such a material. Places in its pictures are already transformed. `instance` is that
// of a triangle of the world; one of a shared mesh has many.
struct SeeThroughTriangle {
  uint instance, triangle;
  uint material;  // into SeeThrough::materials
  uint placed;    // bits 0 to 2: the mesh has coordinates for base, metal, glass
  ARRAY(vec2, 3) base, metal, glass;
  ARRAY(float, 3) alpha;  // of its corners
};
IN_BUFFER(SeeThroughTriangles, SeeThroughTriangle);

struct SeeThrough {
  REF(SeeThroughMaterials) materials;
  REF(SeeThroughTriangles) triangles;
  REF(Texels) texels;
};

struct World {
  REF(Vectors) nodes;  // or the driver's own hierarchy
  REF(Vectors) triangles;
  SeeThrough see_through;
};

const uint kNoTriangle = 0xffffffffu;
const uint kBackFace = 1u << 31;

struct Hit {
  float t, u, v;
  uint number;  // of the triangle, kBackFace added where it is met from behind; or kNoTriangle
};

SHARED_END
#endif
