// Footprint of a texel: the part of it that its chart covers, as points of the surface.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "luxel/atlas/atlas.h"

namespace luxel::atlas {

/// The triangles with which charts cover some texels: those of the chart that owns the texel.
struct Cover {
  std::vector<uint32_t> first;      ///< per texel asked for, one extra entry
  std::vector<uint32_t> triangles;  ///< drawn triangles, ascending per texel

  std::span<const uint32_t> of(size_t k) const {
    return std::span(triangles).subspan(first[k], first[k + 1] - first[k]);
  }
};

/// `texels` are indices into map.texels.
Cover cover_of(const Atlas& atlas, const TexelMap& map, std::span<const uint32_t> texels);

/// Fills `points` with up to `count` points spread evenly, in lightmap area, over the covered part:
/// the first of an Owen-scrambled Sobol sequence in the texel's square that `cover` holds. A part
/// too small to be met by sixteen tries per point gets fewer, or none. The same seed gives the same
/// points; a smaller count gives the first of them.
void spread_points(const Atlas& atlas, const Texel& texel, std::span<const uint32_t> cover,
                   int count, uint64_t seed, std::vector<scene::SurfacePoint>& points);

}  // namespace luxel::atlas
