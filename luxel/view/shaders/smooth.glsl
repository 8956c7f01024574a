// Light of a lightmap at a place: luxel/display/smooth_lookup.h. Texels inside charts have alpha 1.

// The quadratic B-spline, texels away from its middle.
float smooth_weight(float away) {
  float d = abs(away);
  return d < 0.5 ? 0.75 - d * d : 0.5 * max(1.5 - d, 0) * max(1.5 - d, 0);
}

vec3 smooth_light(sampler2D light, vec2 place) {
  vec3 bilinear = textureLod(light, place, 0).rgb;
  ivec2 size = textureSize(light, 0);
  vec2 at = place * vec2(size) - 0.5;
  ivec2 first = ivec2(floor(at)) - 1;
  vec2 to = at - floor(at);
  // Bit 4 y + x: a texel of the 4 x 4 is inside.
  uint inside = 0;
  vec4 sum = vec4(0);
  for (int k = 0; k < 16; ++k) {
    ivec2 cell = ivec2(k & 3, k >> 2), texel = first + cell;
    if (any(lessThan(texel, ivec2(0))) || any(greaterThanEqual(texel, size))) continue;
    vec4 value = texelFetch(light, texel, 0);
    if (value.a < 1) continue;
    inside |= 1u << k;
    vec2 away = to + 1 - vec2(cell);
    sum += vec4(value.rgb, 1) * (smooth_weight(away.x) * smooth_weight(away.y));
  }
  float share = 0;
  for (int k = 0; k < 4; ++k) {
    ivec2 cell = ivec2(k & 1, k >> 1);
    uint around = 0x777u << (cell.x + 4 * cell.y);
    vec2 weight = mix(1 - to, to, vec2(cell));
    if ((inside & around) == around) share += weight.x * weight.y;
  }
  return share > 0 ? mix(bilinear, sum.rgb / sum.a, share) : bilinear;
}
