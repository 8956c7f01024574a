#include "luxel/transport/own_lookups.h"

#include <cmath>

#include "luxel/base/check.h"

namespace luxel::transport {
namespace {

using Four = LookupBuffers::Four;

/// Texels around the four of a look-up that are asked, on each side.
constexpr int kAround = 1;

/// The column and the row of the first of a place's four texels; -1: in the border.
std::array<int, 2> first_texel(const OwnSides& sides, const LookupPlace& place) {
  const int side = int(border_side(sides.map));
  return {int(place.base) % side - 1, int(place.base) / side - 1};
}

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

/// The nearest of the texels around the four that the place sees; kReadsNothing: none.
LookupPlace nearest_around(const TexelSpots& texels, const Spot& here, const LookupPlace& place) {
  const auto [x0, y0] = first_texel(texels.in, place);
  LookupPlace best = kReadsNothing;
  float nearest = INFINITY;
  for (int y = y0 - kAround; y <= y0 + 1 + kAround; ++y)
    for (int x = x0 - kAround; x <= x0 + 1 + kAround; ++x) {
      const uint32_t texel = texels.at(x, y);
      if (texel == atlas::kNone) continue;
      const float away = std::hypot(float(x - x0) - place.fx, float(y - y0) - place.fy);
      if (away >= nearest || !texels.sees(here, texels.spot(texel))) continue;
      nearest = away, best = {uint32_t((y + 1) * int(border_side(texels.in.map)) + x + 1), 0, 0};
    }
  return best;
}

/// Texels beside walls are asked for again and again.
Spot texel_spot(const TexelSpots& texels, uint32_t texel, LookupBuffers& b) {
  if (b.known.empty()) return texels.spot(texel);
  LookupBuffers::KnownSpot& known = b.known[texel % b.known.size()];
  if (known.texel != texel) known = {texel, texels.spot(texel)};
  return known.spot;
}

/// Looks which of their four texels the spots see.
void find_own(const TexelSpots& texels, std::span<const LookupPlace> places, LookupBuffers& b) {
  auto& [rays, hits] = b.traced;
  b.four.assign(places.size(), {}), b.lines.clear(), rays.clear();
  for (uint32_t i = 0; i < places.size(); ++i) {
    const auto [x0, y0] = first_texel(texels.in, places[i]);
    for (uint32_t k = 0; k < 4; ++k) {
      const uint32_t texel = b.four[i].texel[k] = texels.at(x0 + int(k % 2), y0 + int(k / 2));
      if (texel == atlas::kNone) continue;
      const Spot there = texel_spot(texels, texel, b);
      if (is_far(b.here[i], there)) continue;
      b.lines.push_back({i, k, there}), rays.push_back(line_between(b.here[i], there));
    }
  }
  hits.resize(rays.size());
  texels.in.tracer.closest_hits(rays, hits);
  for (size_t n = 0; n < b.lines.size(); ++n) {
    const auto& [i, k, there] = b.lines[n];
    b.four[i].is_own[k] = !is_between(texels.in.scene, texels.in.atlas, b.here[i], there, hits[n]);
  }
}

}  // namespace

void own_lookups(const OwnSides& sides, std::span<const scene::SurfacePoint> points,
                 LookupBuffers& buffers, std::span<LookupPlace> places) {
  LUXEL_CHECK(places.size() == points.size());
  if (points.empty()) return;
  for (size_t i = 0; i < points.size(); ++i) places[i] = lookup_place(sides.atlas, points[i]);
  const TexelSpots texels{sides};
  spots_at(sides.scene, sides.atlas, sides.tracer, points, buffers.traced, buffers.here);
  find_own(texels, places, buffers);
  for (size_t i = 0; i < points.size(); ++i) {
    const LookupPlace own = nearest_own(places[i], buffers.four[i]);
    places[i] =
        own.base != kReadsNothing.base ? own : nearest_around(texels, buffers.here[i], places[i]);
  }
}

LookupPlace own_lookup(const OwnSides& sides, const scene::SurfacePoint& p, MayBeInside inside) {
  LookupPlace place = lookup_place(sides.atlas, p);
  const bool doubtful = inside == MayBeInside::yes && sides.is_beside_solids(place.base);
  if (!doubtful && !sides.is_mixed(place.base)) return place;
  LookupBuffers buffers;
  own_lookups(sides, {&p, 1}, buffers, {&place, 1});
  return place;
}

}  // namespace luxel::transport
