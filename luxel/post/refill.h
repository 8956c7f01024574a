// Texels inside solids get the light of their visible neighbours.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "luxel/atlas/atlas.h"

namespace luxel::post {

/// True where something stands between two texels of one chart, given by their indices.
using Parted = std::function<bool(uint32_t, uint32_t)>;

/// Where an object stands on a floor, texels of the floor half under it lie inside the object and
/// are dark; a bilinear lookup beside the object would see them as a dark or jagged rim. `rings`
/// times, every hidden texel with visible neighbours (of its eight, in its own chart) takes their
/// mean and counts as visible from then on. Deeper texels keep their values. `hidden` and `values`
/// have one entry per texel of the map.
///
/// The neighbours stand on one side of whatever hides the texel: those that `parted` says are
/// parted from the nearest of them do not count. Returns the texels that were filled.
std::vector<uint32_t> refill_hidden(const atlas::Atlas& atlas, const atlas::TexelMap& map,
                                    std::span<const uint8_t> hidden, int rings,
                                    const Parted& parted, std::span<Rgb> values);
/// Refills several arrays of values at once.
std::vector<uint32_t> refill_hidden(const atlas::Atlas& atlas, const atlas::TexelMap& map,
                                    std::span<const uint8_t> hidden, int rings,
                                    const Parted& parted, std::span<const std::span<Rgb>> arrays);

}  // namespace luxel::post
