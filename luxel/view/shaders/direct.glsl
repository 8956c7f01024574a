// Light straight from lamps, as luxel/light/lights.h has it. luxel/view/draw/direct_light.h has the
// structs and the maps of shadows.

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

// The share of four texels around a place of a map that its depth is not behind of.
float lit_share(ShadowMap map, vec3 place) {
  vec4 clip = map.clip_from_world * vec4(place, 1);
  if (clip.w <= 0) return 1;
  vec2 at = clamp((clip.xy / clip.w * 0.5 + 0.5) * map.side - 0.5, vec2(0), vec2(map.side - 1.01));
  vec2 texel = floor(at), part = at - texel;
  // Of the left upper, right upper, right lower and left lower texel: w, z, y, x.
  vec4 lit = textureGather(shadow_maps, (map.corner + texel + 1) / vec2(textureSize(shadow_maps, 0)),
                           clip.z / clip.w);
  vec2 rows = mix(lit.wx, lit.zy, part.x);
  return mix(rows.x, rows.y, part.y);
}

// The share of a lamp's light that nothing is in the way of. What is looked up lies a little before
// the surface, which must not be in its own way: a texel stands for all of its width.
float visible_share(Lamp lamp, vec3 place, vec3 facet, vec3 towards) {
  if (lamp.first_map == 0xffffffffu) return 1;
  vec3 from_lamp = place - lamp.position;
  uint side = lamp.looks_all_round != 0 ? side_of_cube(from_lamp) : 0;
  ShadowMap map = light_now.maps.at[lamp.first_map + side];
  vec3 a = abs(from_lamp);
  float ahead = lamp.kind == 2             ? 1
                : lamp.looks_all_round != 0 ? max(max(a.x, a.y), a.z)
                                            : dot(from_lamp, lamp.direction);
  float cosine = clamp(dot(facet, towards), 0, 1);
  float before = map.texel_m * ahead * (0.3 + 1.5 * sqrt(1 - cosine * cosine));
  vec3 p = place + facet * before;
  if (lamp.looks_all_round != 0) {
    uint now = side_of_cube(p - lamp.position);
    if (now != side) map = light_now.maps.at[lamp.first_map + now];
  }
  return lit_share(map, p);
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
    sum += arriving * (cosine * visible_share(lamp, place, facet, towards));
  }
  return sum;
}
