// Places of texels, and whether they see each other just above the surface.
#pragma once

#include <span>
#include <vector>

#include "luxel/scene/facet.h"
#include "luxel/transport/barriers.h"
#include "luxel/transport/own_side.h"

namespace luxel::transport {

/// The height of a line's end above the surface, in texels: above what lies on it, such as a rug;
/// and beside a wall that leans over it, inside of which the line would begin.
inline constexpr float kLineHeight = 0.05f, kLowHeight = 1e-3f;

/// A place and its chart.
struct Spot {
  FlatPoint at;
  uint32_t chart = 0;
  float width_m = 0;                ///< of a texel there
  float line_height = kLineHeight;  ///< in texels
};

trace::Ray line_between(const Spot& a, const Spot& b);
/// Ray that meets whatever leans over a place.
trace::Ray line_up(const Spot& s);

/// Makes spots over which nothing leans, for all that is known. Those that follow each other mostly
/// lie on one triangle: what its places share is worked out once.
struct SpotMaker {
  const scene::Scene& scene;
  const atlas::Atlas& atlas;
  uint32_t instance = scene::kNone, triangle = 0;  ///< of the last spot
  scene::Facet facet{};
  Spot last{};

  Spot spot(const scene::SurfacePoint& p);
};

Spot spot_at(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::RayTracer& tracer,
             const scene::SurfacePoint& p);
/// Rays, as those up from places, and what they meet; reused from call to call.
struct SpotBuffers {
  std::vector<trace::Ray> rays;
  std::vector<trace::Hit> hits;
};
/// spot_at() of many places, whose rays are traced together, into `out`.
void spots_at(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::RayTracer& tracer,
              std::span<const scene::SurfacePoint> places, SpotBuffers& buffers,
              std::vector<Spot>& out);
std::vector<Spot> spots_at(const scene::Scene& scene, const atlas::Atlas& atlas,
                           const trace::RayTracer& tracer,
                           std::span<const scene::SurfacePoint> places);

/// True where spots of two charts are no neighbours in space.
bool is_far(const Spot& a, const Spot& b);
/// True where the hit of a line from a to b stands between them.
bool is_between(const scene::Scene& scene, const atlas::Atlas& atlas, const Spot& a, const Spot& b,
                const trace::Hit& hit);
bool sees(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::RayTracer& tracer,
          const Spot& a, const Spot& b);

/// Spots at the samples of a map's texels.
struct TexelSpots {
  const OwnSides& in;

  SpotMaker maker() const { return {in.scene, in.atlas}; }
  Spot spot(uint32_t texel, SpotMaker& maker) const {
    Spot out = maker.spot(in.map.texels[texel].sample);
    if (in.is_under(texel)) out.line_height = kLowHeight;
    return out;
  }
  Spot spot(uint32_t texel) const {
    SpotMaker alone = maker();
    return spot(texel, alone);
  }
  uint32_t at(int x, int y) const {
    const int side = in.map.resolution;
    if (x < 0 || y < 0 || x >= side || y >= side) return atlas::kNone;
    return in.map.texel_at[size_t(y) * size_t(side) + size_t(x)];
  }
  uint32_t beside(uint32_t texel, int dx, int dy) const {
    return at(int(in.map.texels[texel].x) + dx, int(in.map.texels[texel].y) + dy);
  }
  bool sees(const Spot& a, const Spot& b) const {
    return transport::sees(in.scene, in.atlas, in.tracer, a, b);
  }
};

/// The side of a map with its border of one texel, as LookupPlace::base counts.
inline uint32_t border_side(const atlas::TexelMap& map) { return uint32_t(map.resolution) + 2; }
/// The four look-ups around each marked texel that read it, as bits.
std::vector<uint64_t> blocks_of(const atlas::TexelMap& map, std::span<const uint8_t> marked);

}  // namespace luxel::transport
