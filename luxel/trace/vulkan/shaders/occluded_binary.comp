// Whether anything lies on each ray, by a binary hierarchy.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "binary.glsl"
#include "occluded.glsl"
