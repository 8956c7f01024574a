// All that paths look at, and from where. C++ and GLSL.
#ifndef LUXEL_REFERENCE_DEVICE_PATHS_SHARED_H
#define LUXEL_REFERENCE_DEVICE_PATHS_SHARED_H
#include "luxel/trace/vulkan/world_shared.h"
SHARED_BEGIN

// A work group has so many slices of receivers or pixels.
const uint kPathThreads = 64;

// A drawn triangle.
struct PathTriangle {
  ARRAY(vec3, 3) corner;
  ARRAY(vec3, 3) normal;                 // of the vertices, of any length
  ARRAY(vec3, 3) color;                  // of the vertices
  ARRAY(float, 3) alpha;                 // of the vertices
  vec3 front;                            // unit
  ARRAY(vec2, 3) base, metal, emission;  // in the pictures
  uint material;
  uint flags;
  uint other_side;  // of a sheet: its number; or kNoTriangle
  float pdf_area;   // with which its points are picked; 0: never
  float size_m;     // the root of its area
  float size_for_rounding_m;
};
const uint kBasePlaced = 1, kMetalPlaced = 2, kEmissionPlaced = 4, kCurved = 8, kBends = 16;
IN_BUFFER(PathTriangles, PathTriangle);

struct PathMaterial {
  vec3 base_color, emission;
  float alpha, cutoff, metallic;
  uint flags;
  Picture base, metal, emission_picture;
};
const uint kDoubleSided = 1, kUnlit = 2, kMasked = 4, kReflectsFromBehind = 8;
IN_BUFFER(PathMaterials, PathMaterial);

struct PathLight {
  vec3 intensity, position, direction;
  float range_m, outer_cosine, ramp;  // ramp: between the cosines of both cones
  float disc_height;                  // 1 - cos(half of the disc's angle)
  float reach;                        // the sine of half of it
  uint kind, has_disc;
};
IN_BUFFER(PathLights, PathLight);

IN_BUFFER(Doubles, double);
IN_BUFFER(Numbers, uint);
IN_BUFFER(MapPixels, vec3);

BLOCK(PathSetup) {
  World world;
  REF(PathTriangles) triangles;
  REF(PathMaterials) materials;
  REF(Texels) texels;
  REF(Floats) linear_of_byte;  // of sRGB
  REF(Numbers) emitters;       // triangles
  REF(Doubles) chance_below;   // of each emitter; one more entry
  REF(PathLights) lights;
  REF(Doubles) row_below, column_below;  // reference::SkySampler
  REF(MapPixels) pixels;
  vec3 background;
  float rotation_rad;
  int map_width, map_height;  // 0: no map
  uint emitter_count, light_count;
};

// trace::CameraRays
BLOCK(Camera) {
  vec3 eye, right, up, forward;
  float width, height;
  uint orthographic;
};

SHARED_END
#endif
