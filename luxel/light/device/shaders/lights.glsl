// What shines in a scene.
#include "luxel/base/both_sobol.h"
#include "luxel/light/both_bright_texel.h"
#include "luxel/light/both_light_group.h"
#include "luxel/light/both_triangle_light.h"
#include "luxel/trace/vulkan/shaders/frame.glsl"

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
IN_BUFFER(LightNodes, LightNode);
#include "luxel/light/device/direct_light_shared.h"

const uint kPoint = 0, kSpot = 1, kDirectional = 2;  // scene::PunctualLight::Kind

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
