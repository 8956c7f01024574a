// The lights of a scene, and the places that they light, as devices have them. C++ and GLSL.
#ifndef LUXEL_LIGHT_DEVICE_DIRECT_LIGHT_SHARED_H
#define LUXEL_LIGHT_DEVICE_DIRECT_LIGHT_SHARED_H
#include "luxel/trace/vulkan/world_shared.h"
SHARED_BEGIN

// A work group has so many places.
const uint kDirectThreads = 64;

// The kinds of sources, each of which a device takes in a step of its own.
const uint kAllTriangles = 0, kDrawnTriangles = 1, kPunctualLights = 2, kDrawnPunctualLights = 3,
           kBrightTexels = 4;

struct TriangleLight {
  vec3 a, b, c, normal;
  vec3 radiance;
  float area_m2, size_m;
  uint instance, triangle, piece;
  uint two_sided;
  uint texture_number;  // 1 + that of a LightTexture; 0: it is even
};
IN_BUFFER(TriangleLights, TriangleLight);

// The emission of a triangle light.
struct LightTexture {
  vec3 emission;
  PlacedPicture picture;  // its places are those of a, b and c
};
IN_BUFFER(LightTextures, LightTexture);

struct PunctualLight {
  vec3 intensity, position, direction;
  float range_m, cos_inner, cos_outer;
  float disc_height;  // 1 - cos(half of the disc's angle)
  uint kind, has_disc;
  vec3 side;
  uint profile;  // 1 + its number; 0: none
};
IN_BUFFER(PunctualLights, PunctualLight);

// scene::LightProfile; its values: vertical angles, horizontal ones, candela
struct LightProfile {
  uint angles, vertical, horizontal;  // how many of both
  uint first;
};
IN_BUFFER(LightProfiles, LightProfile);

IN_BUFFER(Numbers, uint);
IN_BUFFER(Doubles, double);
IN_BUFFER(Pixels, vec3);

BLOCK(LightSetup) {
  World world;
  REF(TriangleLights) triangles;  // in the order of the leaves of nodes
  REF(LightNodes) nodes;
  REF(LightTextures) textures;
  REF(Texels) texels;
  REF(Floats) linear_of_byte;
  REF(PunctualLights) punctual;
  REF(Numbers) punctual_order;  // leaves of punctual_nodes
  REF(LightNodes) punctual_nodes;
  REF(LightProfiles) profiles;
  REF(Floats) profile_values;
  // light::Surroundings, and its map.
  REF(Numbers) bright_texels, guide;
  REF(Doubles) below, row_cosine;
  REF(Pixels) pixels;
  float rotation_rad;
  int map_width;
  uint triangle_count, punctual_count, bright_count;
};

// A place that is lit: light::Receiver.
struct Receiver {
  vec3 position, normal, geometric_normal;
  uvec2 seed;
};
IN_BUFFER(Receivers, Receiver);

// light::LightAt, and the number of shadow rays.
struct LightAt {
  vec3 irradiance;
  float variance, split_variance;
  uint rays;
};
BUFFER(AllLight, LightAt);

PUSH(DirectPush) {
  REF(LightSetup) setup;
  REF(Receivers) receivers;
  REF(AllLight) light;
  uint count, samples;
  uint first_group;
};

SHARED_END
#endif
