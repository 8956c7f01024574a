// Paths, by a binary hierarchy.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "luxel/trace/vulkan/shaders/binary.glsl"
#include "paths.glsl"
