// Texels inside solids get the light of their visible neighbours.
#pragma once

#include <cstdint>
#include <span>

#include "atlas/atlas.h"

namespace luxel::post {

/// Where an object stands on a floor, texels of the floor half under it lie inside the object and
/// are dark; a bilinear lookup beside the object would see them as a dark or jagged rim. `rings`
/// times, every hidden texel with visible neighbours (of its eight, in its own chart) takes their
/// mean and counts as visible from then on. Deeper texels keep their values. `hidden` and `values`
/// have one entry per texel of the map.
void refill_hidden(const atlas::Atlas& atlas, const atlas::TexelMap& map,
                   std::span<const uint8_t> hidden, int rings, std::span<Rgb> values);

}  // namespace luxel::post
