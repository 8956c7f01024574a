// The paths that a dispatch follows, and what they find. C++ and GLSL.
#ifndef LUXEL_REFERENCE_DEVICE_PATH_PUSH_SHARED_H
#define LUXEL_REFERENCE_DEVICE_PATH_PUSH_SHARED_H
#include "luxel/reference/device/paths_shared.h"
SHARED_BEGIN

// reference::Sums of some paths, how many rays they took, and what their first ones met.
struct PathSums {
  double r, g, b, l, r2, g2, b2, l2;
  uint rays, back, double_sided_back, covered;
};
BUFFER(AllSums, PathSums);

PUSH(PathPush) {
  REF(PathSetup) setup;
  REF(Camera) camera;        // of pictures
  REF(Hits) eye_hits;        // of pictures: of each item
  REF(Places) places;        // of receivers
  REF(Numbers) first_place;  // of receivers: of each one; or one each, if there are none
  REF(AllSums) sums;         // of the items
  uvec2 seed;
  uint first_item;  // receiver or pixel
  uint item_count;  // slices of receivers or pixels
  uint slices, samples_of_slice, samples;
  uint first_sample, sample_count;  // of each slice: those of this dispatch
  int bounces;
  uint flags;
  uint first_group;
};
const uint kPicture = 1, kOnePlaceEach = 2;

SHARED_END
#endif
