// Where the rays of elements land, by a binary hierarchy.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "luxel/trace/vulkan/shaders/binary.glsl"
#include "landed_rays.glsl"
