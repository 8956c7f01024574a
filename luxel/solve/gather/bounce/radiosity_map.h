// The radiosity of every texel of the map, as bounces look it up at the ends of rays.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "luxel/atlas/atlas.h"
#include "luxel/base/bytes_per_entry.h"
#include "luxel/solve/gather/rays/hit_store.h"
#include "luxel/transport/elements.h"

namespace luxel::gather {

struct TracedHits;

/// Four floats in one register: R, G, B and coverage.
typedef float Float4 __attribute__((vector_size(16)));

/// Radiosity rho E per texel of the map, with a border of one empty texel. Coverage is 1 where
/// there is an element that is not hidden, so that weights can be renormalised after a bilinear
/// lookup.
struct RadiosityMap {
  uint32_t stride = 0;
  std::vector<Float4> texels;
};
inline constexpr uint64_t kRadiosityBytesPerTexel = bytes_per_entry(&RadiosityMap::texels);

RadiosityMap empty_radiosity_map(int resolution);

/// B = rho E + tau E behind [Moreno05, eq. 3.4], from an irradiance per element. `behind` has one
/// place per element, or none: places_behind(). Texels of elements that are hidden stay as they
/// are: `m` is empty_radiosity_map() at first.
void fill_radiosity(RadiosityMap& m, const atlas::TexelMap& map,
                    const transport::Elements& elements, const TracedHits& hits,
                    std::span<const StoredHit> behind, std::span<const Rgb> irradiance);

/// Bilinear over the texels with an element around the place of a hit, times its tint and weight.
inline Float4 lookup(const RadiosityMap& m, const StoredHit& hit) {
  constexpr float kUnit = 1.0f / float(StoredHit::kSteps);
  const float fx = float(hit.fx()) * kUnit, fy = float(hit.fy()) * kUnit;
  const Float4* upper = m.texels.data() + hit.base();
  const Float4* lower = upper + m.stride;
  const Float4 sum =
      (upper[0] * (1 - fx) + upper[1] * fx) * (1 - fy) + (lower[0] * (1 - fx) + lower[1] * fx) * fy;
  // Coverage is zero only where all texels around the hit are hidden.
  const Float4 mean = sum[3] > 0 ? sum * (hit.weight() / sum[3]) : Float4{};
  if (hit.tint() == kNoTint) return mean;
  const Rgb tint = unpack_tint(hit.tint());
  return mean * Float4{tint.x, tint.y, tint.z, 1};
}

}  // namespace luxel::gather
