// Paths, by a wide hierarchy.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "luxel/trace/vulkan/shaders/wide.glsl"
#include "paths.glsl"
