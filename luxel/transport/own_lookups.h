// Look-ups beside walls, many at a time. docs/method/leaks.md
#pragma once

#include <array>
#include <span>
#include <vector>

#include "luxel/transport/own_side.h"
#include "luxel/transport/spots.h"

namespace luxel::transport {

/// Buffers for look-ups in one map, reused from call to call.
struct LookupBuffers {
  /// Spots of texels that were asked for before.
  struct KnownSpot {
    uint32_t texel = atlas::kNone;
    Spot spot;
  };

  /// The place's four texels: those to the right have bit 0, those below bit 1.
  struct Four {
    std::array<uint32_t, 4> texel{};
    std::array<bool, 4> is_own{};
  };
  /// A line to the k-th of the texels of a place.
  struct Line {
    uint32_t place, k;
    Spot there;
  };
  std::vector<KnownSpot> known;  ///< as many as are to be remembered; none at first
  std::vector<Spot> here;
  std::vector<Four> four;
  std::vector<Line> lines;
  SpotBuffers traced;  ///< of the places, then of the lines
};

/// own_lookup() of points whose four texels lie on several sides of a wall, or may. Their rays are
/// traced together. One place per point.
void own_lookups(const OwnSides& sides, std::span<const scene::SurfacePoint> points,
                 LookupBuffers& buffers, std::span<LookupPlace> places);

}  // namespace luxel::transport
