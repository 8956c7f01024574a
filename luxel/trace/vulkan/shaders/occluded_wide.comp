// Whether anything lies on each ray, by a wide hierarchy.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "wide.glsl"
#include "occluded.glsl"
