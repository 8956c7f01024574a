// Texels that lie beside each other on a surface, whatever the atlas made of it.
#pragma once

#include <cmath>
#include <vector>

#include "luxel/post/denoise.h"

namespace luxel::post {

/// A texel's sample in the world.
struct SurfaceSample {
  Vec3 position;
  float spacing = 0;  ///< side of a texel of its chart in the world [m]; 0: takes no part
  Vec3 normal;
  uint32_t region = 0;  ///< TexelGeometry::region
};

/// Texels near in space but not in the atlas, per block of texels.
struct FarBlock {
  std::vector<uint32_t> end;  ///< per texel of the block: where its list ends in `texel`
  std::vector<uint32_t> texel;
};
inline constexpr size_t kBlockTexels = 1024;
/// At most so many per texel, the nearest ones: 512 bytes.
inline constexpr size_t kMaxFar = 128;

struct Neighbourhood {
  const atlas::TexelMap* map = nullptr;
  int radius = 0;  ///< of windows of the atlas, in texels
  float min_cosine = 0;
  std::vector<SurfaceSample> place;
  std::vector<FarBlock> far;
};

/// Units of Progress per texel: a unit is what one texel takes of a window in eight lanes. Those
/// that lie near borders are found first, and then the far neighbours of these.
inline constexpr uint64_t kBorderUnits = 10, kFarUnits = 80;
inline constexpr uint64_t kNeighbourhoodUnits = kBorderUnits + kFarUnits;

/// Members of a team share the texels out; null: there is none. Errors: cancelled, another member
/// gives up.
Result<Neighbourhood> make_neighbourhood(const TexelGeometry& places, const DenoiseParams& params,
                                         Team* team, Progress& progress);

/// A neighbour's place in the tangent plane of a texel, in texels, and how far it counts: 0 on
/// another surface.
struct Neighbour {
  float u = 0, v = 0;
  float weight = 0;
};

/// A texel that looks around, and what of that does not depend on whom it sees.
struct Around {
  SurfaceSample own;
  Frame frame;
  float min_cosine = 0;
  float texels_per_metre = 0;
  float per_reach2 = 0;  ///< 1 / reach^2 [1/m^2]
  float per_facing = 0;  ///< 1 / (1 - min_cosine)
};

/// `radius` in texels.
inline Around around(const SurfaceSample& own, float radius, float min_cosine) {
  const float scale = own.spacing > 0 ? 1 / own.spacing : 0.0f;
  return {own,   frame_around(own.normal),          min_cosine,
          scale, scale * scale / (radius * radius), 1 / (1 - min_cosine)};
}

/// The weight falls with the square of the distance and with the angle between the normals. Both
/// points must lie near each other's tangent plane: a quarter of a texel, or as far as a sphere
/// rises whose normal turns by 0.4 over that distance.
inline Neighbour neighbour(const Around& a, const SurfaceSample& b) {
  if (a.own.region != b.region) return {};
  const Vec3 d = b.position - a.own.position;
  const float d2 = dot(d, d);
  const float near = 1 - d2 * a.per_reach2;
  const float facing = dot(a.own.normal, b.normal) - a.min_cosine;
  if (near <= 0 || facing <= 0 || b.spacing <= 0) return {};
  const float off = std::max(std::abs(dot(d, a.own.normal)), std::abs(dot(d, b.normal)));
  const float allowed = 0.25f * a.own.spacing;
  if (off > allowed && (off - allowed) * (off - allowed) > 0.04f * d2) return {};
  return {dot(d, a.frame.tangent) * a.texels_per_metre,
          dot(d, a.frame.bitangent) * a.texels_per_metre, near * facing * a.per_facing};
}

/// Calls visit(texel, Neighbour) for those that count but lie elsewhere in the atlas.
template <class Visit>
void for_far_neighbours(const Neighbourhood& n, uint32_t i, const Around& self,
                        const Visit& visit) {
  const FarBlock& block = n.far[i / kBlockTexels];
  const size_t k = i % kBlockTexels;
  for (uint32_t at = k > 0 ? block.end[k - 1] : 0; at < block.end[k]; ++at) {
    const Neighbour found = neighbour(self, n.place[block.texel[at]]);
    if (found.weight > 0) visit(block.texel[at], found);
  }
}

/// Calls visit(texel, Neighbour) for all that count, `i` itself among them, in a fixed order.
template <class Visit>
void for_neighbours(const Neighbourhood& n, uint32_t i, float radius, const Visit& visit) {
  const atlas::TexelMap& map = *n.map;
  const atlas::Texel& t = map.texels[i];
  const Around self = around(n.place[i], radius, n.min_cosine);
  const auto try_one = [&](uint32_t j) {
    const Neighbour found = neighbour(self, n.place[j]);
    if (found.weight > 0) visit(j, found);
  };
  const int reach = std::min(int(radius), n.radius), side = map.resolution;
  const int x0 = std::max(int(t.x) - reach, 0), x1 = std::min(int(t.x) + reach, side - 1);
  const int y0 = std::max(int(t.y) - reach, 0), y1 = std::min(int(t.y) + reach, side - 1);
  for (int y = y0; y <= y1; ++y) {
    const uint32_t* row = map.texel_at.data() + size_t(y) * size_t(side);
    for (int x = x0; x <= x1; ++x)
      if (row[x] != atlas::kNone) try_one(row[x]);
  }
  for_far_neighbours(n, i, self, visit);
}

}  // namespace luxel::post
