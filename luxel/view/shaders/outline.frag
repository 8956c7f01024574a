// A line around what is white in a picture.
#version 460
#extension GL_EXT_scalar_block_layout : require

layout(push_constant, scalar) uniform Push {
  vec3 color;
  float width;  // [pixels]
};
layout(binding = 0) uniform sampler2D mask;
layout(location = 0) out vec4 shown;

const int ways = 16;

// The share of the pixel that lies within the width of the shape, but not in it. What is looked up
// between pixels is a mean, so that the line has soft edges.
void main() {
  vec2 size = vec2(textureSize(mask, 0)), at = gl_FragCoord.xy;
  float own = texture(mask, at / size).r, near = own;
  for (int ring = 1; ring <= 2; ++ring)
    for (int i = 0; i < ways; ++i) {
      float angle = 6.2831853 * float(i) / float(ways);
      vec2 aside = vec2(cos(angle), sin(angle)) * (width * 0.5 * float(ring));
      near = max(near, texture(mask, (at + aside) / size).r);
    }
  float share = clamp(near - own, 0, 1);
  shown = vec4(color * share, share);
}
