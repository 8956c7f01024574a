#include "luxel/transport/own_side.h"

#include <algorithm>

#include "luxel/base/parallel.h"
#include "luxel/transport/spots.h"
#include "luxel/transport/texel_width.h"

namespace luxel::transport {
namespace {

/// Surfaces that decide about a look-up lie no farther from its texels than this, in texels.
constexpr float kReachTexels = 4;

}  // namespace

LookupPlace lookup_place(const atlas::Atlas& atlas, const scene::SurfacePoint& p) {
  const auto& corners = atlas.corners[atlas.triangle_number(p.instance, p.triangle)];
  const Vec2 at = interpolate(corners[0], corners[1], corners[2], p.at);
  const float limit = float(atlas.resolution);
  const float x = std::clamp(at.x, 0.0f, limit) + 0.5f, y = std::clamp(at.y, 0.0f, limit) + 0.5f;
  const uint32_t x0 = uint32_t(x), y0 = uint32_t(y);  // with the border of one texel
  return {y0 * uint32_t(atlas.resolution + 2) + x0, x - float(x0), y - float(y0)};
}

bool has_own_texel(const OwnSides& sides, const scene::SurfacePoint& p) {
  return !sides.is_mixed(lookup_place(sides.atlas, p).base) ||
         own_lookup(sides, p).base != kReadsNothing.base;
}

Rgb own_irradiance_at(const OwnSides& sides, std::span<const Rgb> irradiance,
                      const scene::SurfacePoint& p) {
  const LookupPlace place = own_lookup(sides, p);
  const TexelSpots texels{sides};
  const int side = int(border_side(sides.map));
  const int x0 = int(place.base) % side - 1, y0 = int(place.base) / side - 1;
  Rgb sum{};
  float weight = 0;
  for (int k = 0; k < 4; ++k) {
    const uint32_t texel = texels.at(x0 + k % 2, y0 + k / 2);
    const float w = (k & 1 ? place.fx : 1 - place.fx) * (k & 2 ? place.fy : 1 - place.fy);
    if (texel == atlas::kNone || w <= 0) continue;
    sum += irradiance[texel] * w, weight += w;
  }
  return weight > 0 ? sum / weight : Rgb{};
}

std::vector<uint64_t> lookups_near(const OwnSides& sides, std::span<const Box3> boxes) {
  std::vector<uint8_t> near(sides.map.texels.size());
  parallel_for(near.size(), 1024, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const scene::SurfacePoint& p = sides.map.texels[i].sample;
      const Vec3 at = scene::world_position(sides.scene, p);
      const float reach_m =
          kReachTexels * texel_width_m(sides.scene, sides.atlas, p.instance, p.triangle);
      near[i] = std::ranges::any_of(boxes, [&](const Box3& box) {
        return length(max(max(box.lower - at, at - box.upper), Vec3{})) <= reach_m;
      });
    }
  });
  std::vector<uint64_t> out = blocks_of(sides.map, near);
  out[0] |= 1;
  return out;
}

uint64_t find_on_side(const scene::Scene& scene, const atlas::Atlas& atlas,
                      const trace::RayTracer& tracer, const scene::SurfacePoint& sample,
                      std::span<const scene::SurfacePoint> points, std::span<uint8_t> on_side) {
  const Spot own = spot_at(scene, atlas, tracer, sample);
  const std::vector<Spot> spots = spots_at(scene, atlas, tracer, points);
  std::vector<trace::Ray> rays;
  for (const Spot& spot : spots) rays.push_back(line_between(own, spot));
  std::vector<trace::Hit> hits(rays.size());
  tracer.closest_hits(rays, hits);
  uint64_t traced = 2 * rays.size() + 1;
  for (size_t k = 0; k < points.size(); ++k)
    on_side[k] = !is_between(scene, atlas, own, spots[k], hits[k]);
  // Those that the sample does not see, around a corner, may be seen by others. What lies under a
  // wall that hangs just above the floor sees both sides of it, and must not join them.
  const auto is_under = [&](size_t k) { return spots[k].line_height < kLineHeight; };
  const auto is_seen = [&](size_t k) {
    for (size_t j = 0; j < points.size(); ++j)
      if (on_side[j] && (is_under(k) || !is_under(j)) &&
          (++traced, sees(scene, atlas, tracer, spots[j], spots[k])))
        return true;
    return false;
  };
  for (bool changes = true; changes;) {
    changes = false;
    for (size_t k = 0; k < points.size(); ++k)
      if (!on_side[k] && is_seen(k)) on_side[k] = 1, changes = true;
  }
  return traced;
}

}  // namespace luxel::transport
