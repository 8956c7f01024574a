// All that the steps of relighting read and write: luxel/solve/matrix/relighter.h. C++ and GLSL.
#ifndef LUXEL_SOLVE_DEVICE_RELIGHT_SHARED_H
#define LUXEL_SOLVE_DEVICE_RELIGHT_SHARED_H
#include "luxel/gpu/shared_language.h"
SHARED_BEGIN

// A thread takes a patch, a cluster or a place, or a work group takes a cluster, a leaf or a row of
// blocks.
const uint kRelightThreads = 64;
const uint kPatches = 0, kSendLeaves = 1, kSendUp = 2, kReceiveFar = 3, kHandDown = 4,
           kReceiveLeaves = 5, kBeginSweeps = 6, kPowers = 7, kLate = 8, kForesee = 9,
           kEndSweep = 10, kBounce = 11, kTakeProduct = 12, kBlocks = 13, kFinish = 14,
           kPlaces = 15;
const uint kRelightSteps = 16;

IN_BUFFER(Numbers, uint);
BUFFER(Floats, float);
BUFFER(Colors, vec3);

// matrix::Cluster, and its parent.
struct Cluster {
  uint first, end, child, parent;
};
IN_BUFFER(Clusters, Cluster);

// Moments of a cluster's light: a colour for each of its three functions.
struct Moments {
  ARRAY(vec3, 3) of;
};
BUFFER(AllMoments, Moments);

BLOCK(RelightSetup) {
  // Patches.
  REF(Colors) reflectance, emission;
  REF(Floats) area, sky;
  REF(Numbers) material;
  REF(Numbers) first_probe;
  REF(Numbers) first_glow, glow_material;
  REF(Colors) glow;
  REF(Floats) mean_emission;  // three per material
  REF(Colors) at_probe;       // direct light
  REF(Colors) direct, straight, sent, radiosity, product, irradiance, first_product, gathered,
      indirect;
  // The hierarchy.
  REF(Clusters) clusters;
  REF(Numbers) by_depth;  // clusters, depth by depth
  REF(Numbers) leaves;
  REF(Ups) up;
  REF(Floats) phi;  // three per patch
  REF(Numbers) first_far, first_near;
  REF(Fars) far;
  REF(Nears) near;
  REF(Numbers) entries;  // four bytes each
  REF(AllMoments) moments_sent, moments_received;
  // The coarse scene.
  REF(Numbers) cluster_of;
  REF(Numbers) first_of_coarse, of_coarse;  // patches of each cluster
  REF(Floats) response;                     // per channel, column by column
  REF(Colors) power, late;
  // BC1.
  REF(Numbers) blocks;  // two words each
  REF(Numbers) row, column;
  REF(Colors) row_scale, column_scale;
  REF(Numbers) first_kept;
  REF(AllKept) kept;
  REF(Floats) byte_values;
  // Places.
  REF(Numbers) first_transfer, transfer_patch;
  REF(Floats) transfer_weight;
  REF(Colors) at_place;
  // These change with the lights.
  REF(Floats) radiosity_of_material;  // three per material

  uint patch_count, coarse_count, blocks_per_row;
  uint glow_is_kept;
  vec3 kept_unit;
};

PUSH(StepPush) {
  REF(RelightSetup) setup;
  uint first, count;  // of what threads or groups take
  uint first_group;   // of this dispatch
  vec3 background;
};

SHARED_END
#endif
