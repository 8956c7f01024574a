// What the shaders of insets share: luxel/view/draw/inset.h.
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_scalar_block_layout : require

layout(buffer_reference, scalar) readonly buffer Pixels { uint at[]; };  // 0xaabbggrr

layout(push_constant, scalar) uniform Push {
  Pixels pixels;
  uvec2 corner;  // of the picture [pixels]
  uvec2 size;
  vec2 picture;  // its size
};
