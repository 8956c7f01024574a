// Textures of a scene, looked up as the processor does: ../device_pictures.h.
#extension GL_GOOGLE_include_directive : require
#include "luxel/trace/vulkan/world_shared.h"

const uint kClamp = 1, kMirror = 2;  // scene::Wrap

int wrapped(int i, int n, uint wrap) {
  if (wrap == kClamp) return clamp(i, 0, n - 1);
  int period = wrap == kMirror ? 2 * n : n;
  // The remainder of negative numbers is undefined.
  int j = i >= 0 ? i % period : period - 1 - (-1 - i) % period;
  return j < n ? j : period - 1 - j;
}

float channel_of(Texels texels, Picture p, int x, int y, int channel) {
  uint at = p.first + uint(wrapped(y, int(p.height), p.wrap_v)) * p.width +
            uint(wrapped(x, int(p.width), p.wrap_u));
  return float(bitfieldExtract(texels.at[at], 8 * channel, 8)) / 255.0;
}

// A channel of a picture, between the places of a triangle's corners; 1 without picture or places.
float picture_at(Texels texels, Picture p, bool has_places, vec2 places[3], vec2 uv, int channel) {
  if (p.width == 0 || !has_places) return 1;
  vec2 at = (1 - uv.x - uv.y) * places[0] + uv.x * places[1] + uv.y * places[2];
  at = mix(clamp(at, vec2(-1e6), vec2(1e6)), vec2(0), bvec2(isnan(at.x) || isinf(at.x), isnan(at.y) || isinf(at.y)));
  at *= vec2(p.width, p.height);
  if (p.nearest != 0) return channel_of(texels, p, int(floor(at.x)), int(floor(at.y)), channel);
  vec2 low = floor(at - 0.5), f = at - 0.5 - low;
  ivec2 c = ivec2(low);
  return mix(mix(channel_of(texels, p, c.x, c.y, channel), channel_of(texels, p, c.x + 1, c.y, channel), f.x),
             mix(channel_of(texels, p, c.x, c.y + 1, channel),
                 channel_of(texels, p, c.x + 1, c.y + 1, channel), f.x), f.y);
}

// `linear_of_byte`: of sRGB.
vec4 linear_texel(Texels texels, Floats linear_of_byte, Picture p, int x, int y) {
  uint at = texels.at[p.first + uint(wrapped(y, int(p.height), p.wrap_v)) * p.width +
                            uint(wrapped(x, int(p.width), p.wrap_u))];
  return vec4(linear_of_byte.at[at & 255u], linear_of_byte.at[at >> 8 & 255u],
              linear_of_byte.at[at >> 16 & 255u], float(at >> 24) / 255.0);
}

// Colours are filtered in linear light. 1 without picture or places.
vec4 colour_at(Texels texels, Floats linear_of_byte, Picture p, bool has_places, vec2 places[3], vec2 uv) {
  if (p.width == 0 || !has_places) return vec4(1);
  vec2 at = (1 - uv.x - uv.y) * places[0] + uv.x * places[1] + uv.y * places[2];
  at = mix(clamp(at, vec2(-1e6), vec2(1e6)), vec2(0), bvec2(isnan(at.x) || isinf(at.x), isnan(at.y) || isinf(at.y)));
  at *= vec2(p.width, p.height);
  if (p.nearest != 0) return linear_texel(texels, linear_of_byte, p, int(floor(at.x)), int(floor(at.y)));
  vec2 low = floor(at - 0.5), f = at - 0.5 - low;
  ivec2 c = ivec2(low);
  return mix(mix(linear_texel(texels, linear_of_byte, p, c.x, c.y), linear_texel(texels, linear_of_byte, p, c.x + 1, c.y), f.x),
             mix(linear_texel(texels, linear_of_byte, p, c.x, c.y + 1), linear_texel(texels, linear_of_byte, p, c.x + 1, c.y + 1), f.x), f.y);
}

// Of a triangle's corners: scene.cpp has the same one.
float alpha_between(float alpha[3], vec2 uv) {
  return alpha[0] + (alpha[1] - alpha[0]) * uv.x + (alpha[2] - alpha[0]) * uv.y;
}

vec3 colour_at(Texels texels, Floats linear_of_byte, PlacedPicture p, vec2 uv) {
  return colour_at(texels, linear_of_byte, p.picture, p.is_placed != 0, p.places, uv).xyz;
}
