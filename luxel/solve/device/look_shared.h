// The hemicubes of viewpoints, and what they look at: luxel/solve/hemicube/look.h. C++ and GLSL.
#ifndef LUXEL_SOLVE_DEVICE_LOOK_SHARED_H
#define LUXEL_SOLVE_DEVICE_LOOK_SHARED_H
#include "luxel/solve/device/surroundings_shared.h"
#include "luxel/trace/vulkan/world_shared.h"
SHARED_BEGIN

struct Pixel {
  vec3 direction;  // about +z
  float factor;    // they sum to 1
  uint weight;     // the same; they sum to 2^31
};
IN_BUFFER(Pixels, Pixel);

struct Viewpoint {
  vec3 tangent, bitangent, normal;  // of the hemicube
  vec3 origin;                      // off the surface
  vec3 geometric_normal;
};
IN_BUFFER(Viewpoints, Viewpoint);

// A drawn triangle and what a hit on it means.
struct SeenTriangle {
  uint first_root, grid;  // hemicube::Mesh
  uint other_side;        // of a sheet: its number; or kNoTriangle
  uint flags;             // of the two below
  vec3 emission;
  uint picture;  // of the emission: 1 + a number of PlacedPictures; 0: none
};
const uint kTwoSided = 1, kEmissive = 2;
IN_BUFFER(SeenTriangles, SeenTriangle);
IN_BUFFER(PlacedPictures, PlacedPicture);

// A triangle of the mesh, or one that was cut in two: hemicube::Node.
struct Node {
  ARRAY(vec2, 3) at;
  ARRAY(uint, 3) element;  // of its corners; or the triangle's own, in the first one
  uint child;
};
IN_BUFFER(Nodes, Node);

struct View {
  vec3 emitted;
  uint back, two_sided_back;
};
OUT_BUFFER(Views, View);
BUFFER(Shares, uint);

BLOCK(LookSetup) {
  World world;
  REF(SeenTriangles) triangles;
  REF(Nodes) nodes;
  REF(Pixels) pixels;
  REF(Surroundings) around;
  REF(PlacedPictures) pictures;
  REF(Texels) texels;
  REF(Floats) linear_of_byte;
  uint pixel_count, element_count;
  uint per_vertex;  // else per triangle
};

PUSH(LookPush) {
  REF(LookSetup) setup;
  REF(Viewpoints) from;
  REF(Views) views;
  REF(Shares) shares;  // of each viewpoint: one for each element
  uint first_group;
};

SHARED_END
#endif
