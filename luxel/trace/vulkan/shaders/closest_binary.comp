// What each ray meets first, by a binary hierarchy.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "binary.glsl"
#include "closest.glsl"
