#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_buffer_reference : require

layout(push_constant, scalar) uniform Push {
  uvec2 corners;
  vec4 color;
};
layout(binding = 0) uniform sampler2D map;
layout(location = 0) out vec4 pixel;

void main() { pixel = color * texture(map, vec2(0.25, 0.25)); }
