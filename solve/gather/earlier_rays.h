// The rays of an earlier bake: what each of them met, for a bake of the changed scene, which traces
// only those that can meet something else. docs/rebake.md
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/part_store.h"
#include "solve/gather/element_rays.h"
#include "solve/gather/hit_store.h"
#include "trace/ray_tracer.h"

namespace luxel::gather {

/// How an element's ray ended.
enum class RayEnd : uint8_t {
  hit,      ///< on a surface that the map knows: it has a StoredHit
  behind,   ///< the same, on the back of a surface that reflects from behind
  escaped,  ///< outside
  back,     ///< on the back of a one-sided surface
  followed  ///< where the map has no answer: it was followed on (near_paths.h)
};

/// What an element's rays saw outside: the sum of radiances, that of their squared luminances, and
/// that of the luminances of the second half of the samples.
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
  /// Per element, those of its hits in the order of `ends`, and then those of rays followed on.
  HitTile hits;
  std::vector<EscapedLight> escaped;  ///< per element
};

/// Rounds of a finished bake in a file of records: of each round, by its number, its tiles by
/// theirs, and kSamplesPart, the samples per element after it.
struct EarlierRays {
  const RecordFile* file = nullptr;
  std::vector<Box3> boxes;     ///< where rays may meet something else than then [m]
  std::vector<uint8_t> moved;  ///< per element, 1: it lies elsewhere, and none of its rays is known
  bool surroundings = false;   ///< rays that escaped see something else than then
};
inline constexpr uint64_t kSamplesPart = UINT64_MAX;

/// The samples per element after each round. Nothing: the file has none for so many elements.
std::optional<std::vector<std::vector<uint16_t>>> earlier_rounds(const RecordFile& file,
                                                                 size_t elements);

/// Reused from tile to tile.
struct RayTileBuffer {
  std::vector<std::byte> bytes;
  RayTile rays;
};
/// In the buffer; null where the file has none, a damaged one, or another number of elements.
/// `places`: StoredHit::base() is below.
const RayTile* find_rays(const RecordFile& file, uint64_t round, uint64_t tile, size_t elements,
                         uint32_t places, RayTileBuffer& buffer);
/// `store` may be null.
void keep_rays(PartStore* store, uint64_t round, uint64_t tile, const RayTile& rays);
void keep_samples(PartStore* store, uint64_t round, std::span<const uint16_t> samples);

/// Sets again[k] to 1 where rays[k] meets one of the boxes, for each k of `which`; leaves it as it
/// is elsewhere. The rays start at one place and have unit directions.
void mark_rays(std::span<const Box3> boxes, std::span<const trace::Ray> rays,
               std::span<const uint32_t> which, std::span<uint8_t> again);

/// Cells of directions (element_rays.h) in which rays from a place, about `normal`, may meet a box,
/// as one bit each.
uint64_t cells_towards(std::span<const Box3> boxes, Vec3 from, Vec3 normal,
                       const std::array<Cone, kCells>& cells);

}  // namespace luxel::gather
