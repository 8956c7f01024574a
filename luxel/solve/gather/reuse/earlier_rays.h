// The rays of an earlier bake: what each of them met, for a bake of the changed scene, which traces
// only those that can meet something else. docs/method/rebake.md
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "luxel/base/part_store.h"
#include "luxel/solve/gather/rays/element_rays.h"
#include "luxel/solve/gather/rays/ray_tile.h"
#include "luxel/trace/ray_tracer.h"

namespace luxel::gather {

struct RadiosityMap;

/// Rounds of a finished bake in a file of records: of each round, by its number, its tiles by
/// theirs, and kSamplesPart, the samples per element after it.
struct EarlierRays {
  const RecordFile* file = nullptr;
  std::vector<Box3> boxes;     ///< where rays may meet something else than then [m]
  std::vector<uint8_t> moved;  ///< per element, 1: it lies elsewhere, and none of its rays is known
  bool surroundings = false;   ///< rays that escaped see something else than then
  /// Reflectances and all that shines are as they were: only something that lies elsewhere can
  /// change what rays bring that are followed on.
  bool same_light = false;
  /// With same_light, per element: so near to it the same light arrives from lights [m]; < 0: not
  /// even there; empty: it is not known where.
  std::vector<float> same_light_m;
  /// With same_light: what every texel sent then, if TracedHits::change is wanted; null: it is not.
  const RadiosityMap* sent = nullptr;
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

/// An element's rays of an earlier bake.
struct EarlierElement {
  std::span<const RayEnd> ends;
  std::span<const StoredHit> hits;
  /// Light of those that escaped, as they would see it now; null: not known, and all rays of the
  /// batch need a direction when they are merged.
  const EscapedLight* escaped = nullptr;
  std::span<const FollowedRay> followed{};  ///< those of `ends`
  float near_m = 0;                         ///< RayTile::near_m
  bool follows_again = true;                ///< they may all bring something else
};

/// Sets retraced[k] to 1 where rays[k] meets one of the boxes, for each k of `which`; leaves it as
/// it is elsewhere. The rays start at one place and have unit directions.
void mark_rays(std::span<const Box3> boxes, std::span<const trace::Ray> rays,
               std::span<const uint32_t> which, std::span<uint8_t> retraced);

/// Sets retraced[k] to 1 for those of an element's rays, which start at `from`, that were followed
/// on and took another way than a plain one, or one that may meet one of the boxes after what it
/// met within near_m. `followed` are those of `ends`.
void mark_followed(std::span<const Box3> boxes, Vec3 from, float near_m,
                   std::span<const RayEnd> ends, std::span<const FollowedRay> followed,
                   std::span<uint8_t> retraced);

/// Cells of directions (element_rays.h) whose rays from a place, about `normal` and mirrored above
/// the triangle, may meet a box, as one bit each.
uint64_t cells_towards(std::span<const Box3> boxes, Vec3 from, Vec3 normal, Vec3 geometric_normal,
                       const CellCones& cells);

}  // namespace luxel::gather
