// What lights send into a direction: luxel/light/lights.h.
#include "luxel/base/both_angle.h"
#include "luxel/light/both_punctual_light.h"

// Whether no light has a texture or a profile: shaders are smaller then.
layout(constant_id = 2) const uint kAllEven = 0;

// light::radiance_at(), of what nothing goes through.
vec3 radiance_at(TriangleLight light, vec2 uv) {
  if (kAllEven != 0 || light.texture_number == 0) return light.radiance;
  LightTexture t = setup.textures.at[light.texture_number - 1];
  return t.emission * colour_at(setup.texels, setup.linear_of_byte, t.picture, uv);
}

// Where an angle lies between ascending ones, which reach around it: the entry before it, and the
// share of the next one.
void find_angle(uint first, uint count, float angle, out uint before, out float share) {
  uint low = 0, high = count - 1;
  while (high - low > 1) {
    uint middle = (low + high) / 2;
    if (setup.profile_values.at[first + middle] <= angle)
      low = middle;
    else
      high = middle;
  }
  float a = setup.profile_values.at[first + low], b = setup.profile_values.at[first + low + 1];
  before = low, share = clamp((angle - a) / (b - a), 0.0, 1.0);
}

// Angles come out of a few operations on floats: what is beyond the border by less lies on it.
bool reaches(uint first, uint count, float angle) {
  return angle >= setup.profile_values.at[first] - 1e-6 && angle <= setup.profile_values.at[first + count - 1] + 1e-6;
}

// The vertical and the horizontal angle: scene::LightProfile::Angles.
const uint kPlanesThroughX = 2, kPlanesThroughY = 1;
vec2 angles_of(uint angles, float x, float y, float down) {
  if (angles == kPlanesThroughY) return vec2(arc_tangent(x, down), arc_tangent(-y, length(vec2(x, down))));
  if (angles == kPlanesThroughX) return vec2(arc_tangent(x, length(vec2(y, down))), arc_tangent(-y, down));
  float h = arc_tangent(y, x);
  return vec2(arc_tangent(length(vec2(x, y)), down), h < 0 ? h + 6.283185307179586 : h);
}

float between_rows(uint at, float share) {
  float low = setup.profile_values.at[at];
  return low + share * (setup.profile_values.at[at + 1] - low);
}

// scene::candela_at()
float candela_at(LightProfile p, vec3 aim, vec3 side, vec3 direction) {
  vec2 at = angles_of(p.angles, dot(direction, side), dot(direction, cross(-aim, side)), dot(direction, aim));
  uint columns = p.first + p.vertical, candela = columns + p.horizontal;
  if (!reaches(p.first, p.vertical, at.x)) return 0;
  uint row, column;
  float of_row, of_column;
  find_angle(p.first, p.vertical, at.x, row, of_row);
  if (p.horizontal == 1) return between_rows(candela + row, of_row);
  if (!reaches(columns, p.horizontal, at.y)) return 0;
  find_angle(columns, p.horizontal, at.y, column, of_column);
  float low = between_rows(candela + column * p.vertical + row, of_row);
  return low + of_column * (between_rows(candela + (column + 1) * p.vertical + row, of_row) - low);
}

// light::PunctualIncidence
struct Incidence {
  vec3 irradiance, towards;
  float reach_m;
};
Incidence incidence_at(PunctualLight light, vec3 position) {
  if (light.kind == kDirectional) return Incidence(light.intensity, -light.direction, uintBitsToFloat(0x7f800000u));
  vec3 to_light = light.position - position;
  float distance_m = length(to_light);
  if (distance_m <= 0) return Incidence(vec3(0), vec3(0), 0);
  vec3 towards = to_light * (1 / distance_m);
  float share = share_at_distance(distance_m, light.range_m);
  if (light.kind == kSpot) share *= share_in_cone(-dot(towards, light.direction), light.cos_inner, light.cos_outer);
  if (kAllEven == 0 && light.profile != 0)
    share *= candela_at(setup.profiles.at[light.profile - 1], light.direction, light.side, -towards);
  return Incidence(light.intensity * share, towards, reach_of_shadow_ray(distance_m, light.position));
}
