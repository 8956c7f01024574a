// What the shaders of marks share: luxel/view/mark.h. Places are pixels.
#extension GL_EXT_scalar_block_layout : require

layout(push_constant, scalar) uniform Push {
  vec2 from, to;
  vec2 picture;  // its size
  float radius, edge_width;
  vec3 color, edge;
};
