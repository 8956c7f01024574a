// What the rays of elements meet first, by a binary hierarchy.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "luxel/trace/vulkan/shaders/binary.glsl"
#include "first_hits.glsl"
