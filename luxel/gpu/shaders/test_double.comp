// Doubles numbers: a test of buffers by address.
#version 460
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_scalar_block_layout : require
layout(local_size_x = 64) in;

layout(buffer_reference, scalar) buffer Numbers { uint at[]; };
layout(push_constant, scalar) uniform Push {
  Numbers numbers;
  uint count;
};

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i < count) numbers.at[i] *= 2;
}
