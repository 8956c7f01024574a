// What each ray meets first, by a wide hierarchy.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "wide.glsl"
#include "closest.glsl"
