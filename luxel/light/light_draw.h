// Some of many lights, in proportion to what they bring: a cut through the light tree where groups
// differ most, and below the cut one way down the tree for each ray. [Walter05, Conty18]
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "luxel/light/both_light_group.h"
#include "luxel/light/light_tree.h"

namespace luxel::light {

/// A light and its share of the rays.
struct LightDraw {
  uint32_t light = 0;  ///< in the order of the tree's leaves
  uint32_t count = 0;  ///< rays
  float chance = 1;    ///< of being drawn at all; 1: for certain
};

/// A group of the cut, or a single light.
struct CutEntry {
  uint32_t node = 0;
  float importance = 0;
  float spread = 0;  ///< how much the members differ; 0 for a single light
};

struct LightDraws {
  std::vector<LightDraw> draws;
  std::vector<CutEntry> cut;  ///< a buffer
};

struct DrawParams {
  int samples = 64;                ///< rays to share out: in the mean, as many are drawn
  size_t max_cut = both::kMaxCut;  ///< groups among which light is shared out by their importance
  float start = 0;                 ///< random, in [0, 1)
};

/// Importance of a single light, like that of a group (importance_at): zero only where nothing can
/// arrive.
using LeafImportance = std::function<float(const LightNode&)>;

/// Systematic sampling. The lights lie on a line in the order of the tree, so that neighbours in
/// space are neighbours on it, each as long as it is important, together `samples` long; rays go to
/// those that hold start, start + 1, start + 2, ...: spread evenly over space as over importance. A
/// light longer than 1 is drawn for certain. Time: max_cut log(max_cut) + samples log(lights).
/// Draws of certain lights come first, then the others in the order of the line.
void draw_lights(std::span<const LightNode> nodes, Vec3 position, Vec3 normal,
                 const LeafImportance& leaf, const DrawParams& params, LightDraws& out);

}  // namespace luxel::light
