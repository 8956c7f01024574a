#include "luxel/transport/own_side.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "luxel/base/parallel.h"
#include "luxel/transport/spots.h"
#include "luxel/transport/texel_width.h"

namespace luxel::transport {
namespace {

/// Texels around the four of a look-up that are asked, on each side.
constexpr int kAround = 1;
/// How far from a look-up's texels what decides about it lies, at most.
constexpr float kReachTexels = 4;

/// The place's four texels: those to the right have bit 0, those below bit 1.
struct Four {
  std::array<uint32_t, 4> texel{};
  std::array<bool, 4> is_own{};
};

/// The weight with which the own ones of the four are read; 0 where others are read, too.
float weight_of(const Four& four, float fx, float fy) {
  float sum = 0;
  for (size_t k = 0; k < 4; ++k) {
    const float w = (k & 1 ? fx : 1 - fx) * (k & 2 ? fy : 1 - fy);
    if (w <= 0 || four.texel[k] == atlas::kNone) continue;
    if (!four.is_own[k]) return 0;
    sum += w;
  }
  return sum;
}

/// Looks which of the four the place sees. Their lines are traced together.
void find_own(const OwnSides& sides, const Spot& here, Four& four) {
  const TexelSpots texels{sides};
  SpotMaker maker = texels.maker();
  std::array<Spot, 4> there;
  std::array<trace::Ray, 4> lines;
  std::array<trace::Hit, 4> hits;
  std::array<size_t, 4> of{};
  size_t count = 0;
  for (size_t k = 0; k < 4; ++k) {
    if (four.texel[k] == atlas::kNone) continue;
    there[k] = texels.spot(four.texel[k], maker);
    if (!is_far(here, there[k])) lines[count] = line_between(here, there[k]), of[count++] = k;
  }
  sides.tracer.closest_hits(std::span(lines).first(count), std::span(hits).first(count));
  for (size_t n = 0; n < count; ++n)
    four.is_own[of[n]] = !is_between(sides.scene, sides.atlas, here, there[of[n]], hits[n]);
}

/// The place nearest to `p` that reads own texels alone; kReadsNothing: none of the four is.
LookupPlace nearest_own(const LookupPlace& p, const Four& four) {
  const auto distance = [&](float fx, float fy) { return std::hypot(fx - p.fx, fy - p.fy); };
  LookupPlace best = kReadsNothing;
  float nearest = INFINITY;
  for (const float fx : {p.fx, 0.0f, 1.0f})
    for (const float fy : {p.fy, 0.0f, 1.0f})
      if (weight_of(four, fx, fy) > 0 && distance(fx, fy) < nearest)
        nearest = distance(fx, fy), best = {p.base, fx, fy};
  return best;
}

}  // namespace

LookupPlace lookup_place(const atlas::Atlas& atlas, const scene::SurfacePoint& p) {
  const auto& corners = atlas.corners[atlas.triangle_number(p.instance, p.triangle)];
  const Vec2 at = interpolate(corners[0], corners[1], corners[2], p.at);
  const float limit = float(atlas.resolution);
  const float x = std::clamp(at.x, 0.0f, limit) + 0.5f, y = std::clamp(at.y, 0.0f, limit) + 0.5f;
  const uint32_t x0 = uint32_t(x), y0 = uint32_t(y);  // with the border of one texel
  return {y0 * uint32_t(atlas.resolution + 2) + x0, x - float(x0), y - float(y0)};
}

LookupPlace own_lookup(const OwnSides& sides, const scene::SurfacePoint& p, MayBeInside inside) {
  const LookupPlace place = lookup_place(sides.atlas, p);
  const bool doubtful = inside == MayBeInside::yes && sides.is_beside_solids(place.base);
  if (!doubtful && !sides.is_mixed(place.base)) return place;
  const TexelSpots texels{sides};
  const Spot here = spot_at(sides.scene, sides.atlas, sides.tracer, p);
  const int side = int(border_side(sides.map));
  const int x0 = int(place.base) % side - 1, y0 = int(place.base) / side - 1;
  Four four;
  for (int k = 0; k < 4; ++k) four.texel[size_t(k)] = texels.at(x0 + k % 2, y0 + k / 2);
  find_own(sides, here, four);
  const LookupPlace own = nearest_own(place, four);
  if (own.base != kReadsNothing.base) return own;
  // None of the four: the nearest of those around them.
  LookupPlace best = kReadsNothing;
  float nearest = INFINITY;
  for (int y = y0 - kAround; y <= y0 + 1 + kAround; ++y)
    for (int x = x0 - kAround; x <= x0 + 1 + kAround; ++x) {
      const uint32_t texel = texels.at(x, y);
      if (texel == atlas::kNone) continue;
      const float away = std::hypot(float(x - x0) - place.fx, float(y - y0) - place.fy);
      if (away >= nearest || !texels.sees(here, texels.spot(texel))) continue;
      nearest = away, best = {uint32_t((y + 1) * side + x + 1), 0, 0};
    }
  return best;
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
  // Those that the sample does not see, around a corner, may be seen by others.
  const auto is_seen = [&](size_t k) {
    for (size_t j = 0; j < points.size(); ++j)
      if (on_side[j] && (++traced, sees(scene, atlas, tracer, spots[j], spots[k]))) return true;
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
