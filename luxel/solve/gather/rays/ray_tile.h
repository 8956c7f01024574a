// Ends of the rays of a tile's elements, ray by ray.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "luxel/base/vec.h"
#include "luxel/solve/gather/rays/followed_rays.h"
#include "luxel/solve/gather/rays/hit_store.h"

namespace luxel::gather {

/// The end of an element's ray.
enum class RayEnd : uint8_t {
  hit,      ///< on a surface that the map knows: it has a StoredHit
  behind,   ///< the same, on the back of a surface that reflects from behind
  escaped,  ///< outside
  back,     ///< on the back of a one-sided surface
  followed  ///< where the map has no answer: it was followed on (near_paths.h)
};

/// Light that an element's rays saw outside: sums of the radiances, of their squared luminances,
/// and of the luminances of the second half of the samples.
struct EscapedLight {
  Rgb sum{};
  float luminance2 = 0, second_luminance = 0;

  void add(Rgb radiance, bool second_half) { change(radiance, second_half, 1); }
  void take_away(Rgb radiance, bool second_half) { change(radiance, second_half, -1); }
  void change(Rgb radiance, bool second_half, float sign) {
    const float l = luminance(radiance);
    sum += radiance * sign, luminance2 += sign * l * l;
    if (second_half) second_luminance += sign * l;
  }
};

/// A tile of a round, ray by ray.
struct RayTile {
  /// Element after element, each's rays in the order of RayBatch.
  std::vector<RayEnd> ends;
  /// Per element, those of its hits in the order of `ends`, and then, in that order, too, those of
  /// rays followed on.
  HitTile hits;
  std::vector<EscapedLight> escaped;  ///< per element
  std::vector<FollowedRay> followed;  ///< one for each such end
  /// Per element, how far from where its rays start the plain ones of `followed` met something [m].
  std::vector<float> near_m;
};

/// The number of rays that ended so.
size_t count_of(std::span<const RayEnd> ends, RayEnd end);
/// The first byte from `from` on that has the value; bytes.size() where there is none.
size_t next_of(std::span<const std::byte> bytes, uint8_t value, size_t from);
/// The first ray from `from` on that was followed on; ends.size() where there is none.
size_t next_followed(std::span<const RayEnd> ends, size_t from);

}  // namespace luxel::gather
