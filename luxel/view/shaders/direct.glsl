// Light straight from lamps, as luxel/light/lights.h has it. luxel/view/draw/direct_light.h has the
// maps of shadows. `lamps_drawn` is a constant of the shader that includes it, and
// turn_of_place() an angle that differs from place to place.

// E on a surface that faces the lamp squarely, and the way to it.
vec3 arriving_from(Lamp lamp, vec3 place, out vec3 towards, out float distance_m) {
  distance_m = 0;
  towards = -lamp.direction;
  if (lamp.kind == 2) return lamp.intensity;
  vec3 to_lamp = lamp.position - place;
  distance_m = length(to_lamp);
  if (distance_m <= 0) return vec3(0);
  towards = to_lamp / distance_m;
  float factor = 1 / (distance_m * distance_m);
  if (lamp.range_m > 0) {
    float q = distance_m / lamp.range_m;
    factor *= clamp(1 - q * q * q * q, 0, 1);
  }
  if (lamp.kind == 1) {
    float t = clamp((-dot(towards, lamp.direction) - lamp.cos_outer) * lamp.cone, 0, 1);
    factor *= t * t;
  }
  return lamp.intensity * factor;
}

uint side_of_cube(vec3 d) {
  vec3 a = abs(d);
  if (a.x >= a.y && a.x >= a.z) return d.x < 0 ? 1 : 0;
  if (a.y >= a.z) return d.y < 0 ? 3 : 2;
  return d.z < 0 ? 5 : 4;
}

// Shares of four texels side by side, for a place `part` of the way from the second to the third: a
// cubic B-spline, whose edges are smooth where a step of one texel would show.
vec4 spline(float part) {
  float rest = 1 - part, p2 = part * part, r2 = rest * rest;
  return vec4(r2 * rest, 4 - 6 * p2 + 3 * p2 * part, 4 - 6 * r2 + 3 * r2 * rest, p2 * part) / 6;
}

// The share of 4 x 4 texels around a place of a map that its depth is not behind of.
float lit_share(ShadowMap map, vec3 place) {
  vec4 clip = map.clip_from_world * vec4(place, 1);
  if (clip.w <= 0) return 1;
  vec2 at = clamp((clip.xy / clip.w * 0.5 + 0.5) * map.side - 0.5, vec2(1), vec2(map.side - 2.01));
  vec2 texel = floor(at);
  vec4 x = spline(at.x - texel.x), y = spline(at.y - texel.y);
  vec2 size = vec2(textureSize(shadow_maps, 0));
  float sum = 0;
  for (int v = 0; v < 2; ++v)
    for (int u = 0; u < 2; ++u) {
      vec2 corner = (map.corner + texel + vec2(2 * u, 2 * v)) / size;
      // The left upper, right upper, right lower and left lower texel: w, z, y, x.
      vec4 lit = textureGather(shadow_maps, corner, clip.z / clip.w);
      vec2 across = u == 0 ? x.xy : x.zw, down = v == 0 ? y.xy : y.zw;
      sum += down.x * dot(across, lit.wz) + down.y * dot(across, lit.xy);
    }
  return sum;
}

// The k-th of n points in a disc of radius 1, spread by the golden angle and turned: evenly for a `power` of
// 0.5, and denser in the middle for a larger one.
vec2 in_disc(int k, int n, float turn, float power) {
  float angle = float(k) * 2.39996323 + turn;
  return pow((float(k) + 0.5) / float(n), power) * vec2(cos(angle), sin(angle));
}

const int kSearched = 32, kFiltered = 40;

// The share of a sun's disc that is seen, by what the map has in its way [Fernando05]: from a place
// in the map, `texels_per_depth` is how far the disc's rim leads for what is nearer to the sun by 1.
// `slope` is how the surface's own depth changes from texel to texel.
float seen_share(ShadowMap map, vec3 place, float texels_per_depth, vec2 slope) {
  vec3 clip = (map.clip_from_world * vec4(place, 1)).xyz;
  vec2 at = (clip.xy * 0.5 + 0.5) * map.side, size = vec2(textureSize(shadow_maps, 0));
  vec2 low = vec2(0.5), high = vec2(map.side - 0.5);
  float turn = turn_of_place(), sum = 0, weight = 0;
  float searched = (0.76 - clip.z) * texels_per_depth;
  // What is near is searched more densely: of it, less of what is around can be in the way. It counts
  // by how much of the disc a texel of it hides, so that corners stay dark.
  for (int k = -1; k < kSearched; ++k) {
    vec2 aside = k < 0 ? vec2(0) : in_disc(k, kSearched, turn, 1.5) * searched;
    vec2 texel = clamp(at + aside, low, high);
    float nearer = textureLod(shadow_depth, (map.corner + texel) / size, 0).r - clip.z;
    if (nearer <= max(dot(slope, aside), 0) || length(aside) > nearer * texels_per_depth) continue;
    nearer = max(nearer, 0.5 / texels_per_depth);
    sum += 1 / nearer, weight += 1 / (nearer * nearer);
  }
  float radius = weight > 0 ? sum / weight * texels_per_depth : 0;
  if (radius < 2) return lit_share(map, place);
  float lit = 0;
  for (int k = 0; k < kFiltered; ++k) {
    vec2 aside = in_disc(k, kFiltered, turn, 0.5) * radius;
    vec2 texel = clamp(at + aside, low, high);
    lit += textureLod(shadow_maps, vec3((map.corner + texel) / size, clip.z + dot(slope, aside)), 0);
  }
  return lit / float(kFiltered);
}

// How the depth of a facet in a directional map changes from texel to texel.
vec2 slope_of(ShadowMap map, vec3 facet, vec3 forward) {
  mat4 m = map.clip_from_world;
  vec3 right = normalize(vec3(m[0][0], m[1][0], m[2][0]));
  vec3 up = normalize(vec3(m[0][1], m[1][1], m[2][1]));
  float along = min(dot(facet, forward), -0.05);
  return vec2(dot(facet, right), dot(facet, up)) * (map.texel_m / (along * map.depth_m));
}

// The finest map of a sun that shows a place and all around that is looked up for it.
uint map_of_sun(Lamp lamp, vec3 place) {
  for (uint k = 0; k + 1 < lamp.map_count; ++k) {
    ShadowMap map = light_now.maps.at[lamp.first_map + k];
    vec3 clip = abs((map.clip_from_world * vec4(place, 1)).xyz);
    float texels = 6 + (0.76 - clip.z) * lamp.tan_radius * map.depth_m / map.texel_m;
    if (max(clip.x, clip.y) < 1 - 2 * texels / map.side) return k;
  }
  return lamp.map_count - 1;
}

vec3 axis_of_side(uint side) {
  float way = side % 2 == 0 ? 1 : -1;
  return side < 2 ? vec3(way, 0, 0) : side < 4 ? vec3(0, way, 0) : vec3(0, 0, way);
}

// The share of a lamp's light that nothing is in the way of. A surface must not be in its own way: a
// texel has one depth for all of its width. Looked up is a place before the surface by what the
// surface's depth changes over the texels of a look-up, two to each side. With the surface p n = c,
// depth w and a place s at w = 1, w = c / n (s, 1): along s it changes by w |n_s| / n (s, 1), and with
// c by 1 / n (s, 1). So c is to change by w |n_s| times the width.
float visible_share(Lamp lamp, vec3 place, vec3 facet) {
  if (lamp.first_map == 0xffffffffu) return 1;
  vec3 from_lamp = place - lamp.position;
  bool all_round = lamp.looks_all_round != 0;
  uint side = all_round ? side_of_cube(from_lamp) : lamp.kind == 2 ? map_of_sun(lamp, place) : 0;
  vec3 forward = all_round ? axis_of_side(side) : lamp.direction;
  ShadowMap map = light_now.maps.at[lamp.first_map + side];
  float depth = lamp.kind == 2 ? 1 : dot(from_lamp, forward);
  float along = dot(facet, forward);
  vec3 p = place + facet * (map.texel_m * depth * (0.2 + 2.9 * sqrt(max(1 - along * along, 0))));
  if (lamps_drawn < 2 || lamp.tan_radius <= 0) return lit_share(map, p);
  float texels_per_depth = lamp.tan_radius * map.depth_m / map.texel_m;
  return seen_share(map, p, texels_per_depth, slope_of(map, facet, forward));
}

// E at a place with this normal, on a facet that looks this way.
vec3 direct_light(vec3 place, vec3 normal, vec3 facet) {
  vec3 sum = vec3(0);
  for (uint i = 0; i < light_now.lamp_count; ++i) {
    Lamp lamp = light_now.lamps.at[i];
    vec3 towards;
    float distance_m;
    vec3 arriving = arriving_from(lamp, place, towards, distance_m);
    float cosine = dot(normal, towards);
    if (cosine <= 0 || dot(facet, towards) <= 0 || max(max(arriving.r, arriving.g), arriving.b) <= 0)
      continue;
    sum += arriving * (cosine * visible_share(lamp, place, facet));
  }
  return sum;
}
