// The rays of all elements, traced once: for every ray, which place of the lightmap it met.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "base/progress.h"
#include "base/result.h"

namespace luxel::gather {

/// Where a ray met the lightmap: the upper left of the four texels around the point, and how far
/// the point is towards the lower right one, in 1/65535 of a texel.
struct StoredHit {
  uint32_t base = 0;  ///< index into a map with a border of one texel: (y + 1) * (side + 2) + x + 1
  uint16_t fx = 0, fy = 0;
};
static_assert(sizeof(StoredHit) == 8);

/// The hits of kTileElements neighbouring elements.
struct HitTile {
  std::vector<uint32_t> end;    ///< per element: one past its last hit
  std::vector<StoredHit> hits;  ///< element after element; rays that met no light are left out
};

/// Small enough that many threads end at about the same time.
inline constexpr size_t kTileElements = 256;

/// Keeps tiles in memory up to a limit and the rest in a temporary file, which has no name and is
/// gone with the store, however the program ends.
class HitStore {
 public:
  /// `max_hits_per_element` and `memory_limit_bytes` decide beforehand which tiles go to the file,
  /// so that the choice does not depend on threads.
  static Result<HitStore> create(size_t element_count, size_t max_hits_per_element,
                                 uint64_t memory_limit_bytes,
                                 const std::filesystem::path& scratch_folder);
  HitStore(HitStore&&) noexcept;
  HitStore& operator=(HitStore&&) noexcept;
  ~HitStore();

  size_t tile_count() const;
  /// Thread-safe for different tiles. Errors: the disk is full.
  Status put(size_t tile, HitTile hits);
  /// The tile itself, or, when it lies in the file, a copy read into `buffer`. Thread-safe.
  Result<const HitTile*> get(size_t tile, HitTile& buffer) const;
  uint64_t bytes_in_memory() const;
  uint64_t bytes_in_file() const;

 private:
  struct Impl;
  explicit HitStore(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace luxel::gather
