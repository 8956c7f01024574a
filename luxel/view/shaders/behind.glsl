// What stands behind all surfaces. luxel/scene/environment.h has the map's shape.
#extension GL_EXT_scalar_block_layout : require

layout(push_constant, scalar) uniform Push {
  vec3 forward, right, up;  // of the picture's middle, and to its edges
  vec3 background;
  vec3 map_scale;  // 0: there is no map
  float rotation;
  float exposure;
  uint show;
};
