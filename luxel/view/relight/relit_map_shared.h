// Light of places on its way to the picture that shaders look up. C++ and GLSL.
#ifndef LUXEL_VIEW_RELIGHT_RELIT_MAP_SHARED_H
#define LUXEL_VIEW_RELIGHT_RELIT_MAP_SHARED_H
#include "luxel/gpu/shared_language.h"
SHARED_BEGIN

// A work group has so many threads, each of which takes a place or a pixel.
const uint kMapThreads = 64;
const uint kMapPlaces = 0, kMapGutter = 1, kMapLargest = 2, kMapHalves = 3;

IN_BUFFER(Light, vec3);
IN_BUFFER(Numbers, uint);
BUFFER(Pixels, vec3);
BUFFER(Halves, uvec2);

// view::MapPlaces, and what becomes of them.
BLOCK(RelitMap) {
  REF(Light) light;
  REF(Numbers) place, pixel;
  REF(Numbers) gutter, first, from;
  REF(Pixels) pixels;   // E
  REF(Number) largest;  // the bits of a float
  REF(Halves) halves;
  REF(Scale) scale;  // E = scale * half
  uint pixel_count;
};

PUSH(MapPush) {
  REF(RelitMap) map;
  uint begin, end;  // places, pixels of the gutter, or pixels
};

SHARED_END
#endif
