// What stands behind all surfaces. luxel/scene/environment.h has the map's shape.
#extension GL_EXT_scalar_block_layout : require

layout(push_constant, scalar) uniform Push {
  vec3 forward, right, up;  // of the picture's middle, and to its edges
  vec3 background;
  float map_scale, rotation;  // scale 0: there is no map
  float exposure;
  uint show;
};
