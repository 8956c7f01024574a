// Triangles whose corners are read from a buffer.
#version 460
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_scalar_block_layout : require

layout(buffer_reference, scalar) readonly buffer Corners { vec4 at[]; };
layout(push_constant, scalar) uniform Push {
  Corners corners;
  vec4 color;
};

void main() { gl_Position = corners.at[gl_VertexIndex]; }
