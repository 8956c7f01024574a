// What the shaders of shapes share: luxel/view/draw/shapes.h.
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_scalar_block_layout : require

struct Corner {
  vec3 place;
  vec3 color;
  float opacity;
};
layout(buffer_reference, scalar) readonly buffer Corners { Corner at[]; };

layout(push_constant, scalar) uniform Push {
  mat4 clip_from_world;
  Corners corners;
  vec2 picture;  // its size [pixels]
  float width;   // of lines and discs [pixels]
  float nearer, nearer_parallel;
  uint kind;  // 0 triangles, 1 lines, 2 discs
  uint curve;
};
