// What shines in a scene: ../device_lights.cpp has the structs.
#include "luxel/base/both_sobol.h"
#include "luxel/light/both_bright_texel.h"
#include "luxel/light/both_light_group.h"
#include "luxel/light/both_triangle_light.h"
#include "luxel/trace/vulkan/shaders/frame.glsl"

struct TriangleLight {
  vec3 a, b, c, normal;
  vec3 radiance;
  float area_m2, size_m;
  uint instance, triangle, piece;
  uint two_sided;
  uint texture_number;  // 1 + that of a LightTexture; 0: it is even
};
struct LightTexture {
  vec3 emission;
  PlacedPicture picture;
};
// light::LightNode
struct LightNode {
  vec3 centre;
  float radius_m, power;
  vec3 facing;
  float even;
  vec3 axis;
  float angle_rad, cos_angle, sin_angle, reach_m;
  uint first, count;
  uint right_child;  // 0: a leaf
};
const uint kPoint = 0, kSpot = 1, kDirectional = 2;  // scene::PunctualLight::Kind
struct PunctualLight {
  vec3 intensity, position, direction;
  float range_m, cos_inner, cos_outer;
  float disc_height;  // 1 - cos(half of the disc's angle)
  uint kind, has_disc;
  vec3 side;
  uint profile;  // 1 + its number; 0: none
};
// scene::LightProfile; its values: vertical angles, horizontal ones, candela
struct LightProfile {
  uint angles, vertical, horizontal;
  uint first;
};
layout(buffer_reference, scalar) readonly buffer TriangleLights { TriangleLight at[]; };
layout(buffer_reference, scalar) readonly buffer LightTextures { LightTexture at[]; };
layout(buffer_reference, scalar) readonly buffer LightProfiles { LightProfile at[]; };
layout(buffer_reference, scalar) readonly buffer LightNodes { LightNode at[]; };
layout(buffer_reference, scalar) readonly buffer PunctualLights { PunctualLight at[]; };
layout(buffer_reference, scalar) readonly buffer Numbers { uint at[]; };
layout(buffer_reference, scalar) readonly buffer Doubles { double at[]; };
layout(buffer_reference, scalar) readonly buffer Pixels { vec3 at[]; };

layout(buffer_reference, scalar) buffer Setup {
  World world;
  TriangleLights triangles;  // in the order of the leaves of nodes
  LightNodes nodes;
  LightTextures textures;
  Texels texels;
  Floats linear_of_byte;
  PunctualLights punctual;
  Numbers punctual_order;  // leaves of punctual_nodes
  LightNodes punctual_nodes;
  LightProfiles profiles;
  Floats profile_values;
  // light::Surroundings, and its map.
  Numbers bright_texels, guide;
  Doubles below, row_cosine;
  Pixels pixels;
  float rotation_rad;
  int map_width;
  uint triangle_count, punctual_count, bright_count;
};

LightTriangle triangle_of(TriangleLight light) {
  return LightTriangle(light.a, light.b, light.c, light.normal, light.area_m2, light.two_sided != 0);
}

LightGroup group_of(LightNode n) {
  return LightGroup(n.centre, n.radius_m, n.power, n.facing, n.even, n.axis, n.cos_angle, n.sin_angle,
                    n.reach_m);
}

// luxel/base/random.h
vec2 sobol_owen_2d(uint index, uvec2 seed) {
  return vec2(unit_float(reverse_bits(scramble_upwards(index, seed.x))),
              unit_float(reverse_bits(scramble_upwards(sobol_second_reversed(index), seed.y))));
}
// The first numbers of a RandomStream.
float random_float(uvec2 seed) { return unit_float(hash64(seed, uvec2(0)).y); }
vec2 random_vec2(uvec2 seed) {
  uvec2 bits = hash64(seed, uvec2(0));
  return vec2(unit_float(bits.y), unit_float(bits.x));
}
// std::lround() of what is not below 0.
uint rounded(double x) { return uint(x) + (x - floor(x) >= 0.5 ? 1 : 0); }
