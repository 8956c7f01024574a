// The patch that a ray meets, found by place, direction and material.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "luxel/base/vec.h"
#include "luxel/trace/ray_tracer.h"

namespace luxel::matrix {

inline constexpr uint32_t kNone = UINT32_MAX;
/// Directions that differ by more are different patches: 37 degrees.
inline constexpr float kSameDirection = 0.8f;

/// A place on a patch.
struct PatchPoint {
  Vec3 position;  ///< [m], off the surface by what rounding may do (luxel/scene/off_surface.h)
  Vec3 normal;    ///< unit, geometric, front side
};

/// The voxel grid that surfaces are cut by.
struct VoxelGrid {
  float voxel_m = 1;
  Vec3 origin;        ///< of voxel 0, 0, 0
  float cover_m = 0;  ///< transport::size_for_covers of voxel_m
};

/// 21 bits per axis; places outside the grid fall into its border.
uint64_t voxel_of(const VoxelGrid& grid, Vec3 position);

/// transport::open_share by cover_m: below 1 where something much closer covers a place.
/// No patch carries the light there.
float open_share(const trace::RayTracer& tracer, const PatchPoint& p, const VoxelGrid& grid);
inline bool is_covered(const trace::RayTracer& tracer, const PatchPoint& p, const VoxelGrid& grid) {
  return open_share(tracer, p, grid) < 1;
}

/// True where two places of surfaces see each other from a little above their surfaces.
bool see_each_other(const trace::RayTracer& tracer, const PatchPoint& a, const PatchPoint& b,
                    float voxel_m);

/// Finds the patch of a surface point that a ray met.
class PatchLocator {
 public:
  /// A part of a voxel's surfaces, known by one of its points.
  struct Part {
    PatchPoint seed;
    uint32_t material = 0, patch = 0;  ///< patch kNone: inside a solid, or covered
    bool covered = false;
  };
  PatchLocator() = default;
  /// voxel[k] is where parts[k] lies; ascending.
  PatchLocator(const VoxelGrid& grid, std::span<const uint64_t> voxel, std::vector<Part> parts);

  /// The patch at a place just off the front side; kNone inside a solid, where it is covered, or
  /// when no surface of the kind is near. Parts of one voxel that look alike are told apart by
  /// sight of their seeds.
  uint32_t locate(Vec3 position, Vec3 normal, uint32_t material,
                  const trace::RayTracer& tracer) const;
  /// The grid that surfaces were cut by.
  const VoxelGrid& grid() const { return grid_; }
  /// Patches in the voxels within `reach` steps of a place, each once, ascending.
  void near(Vec3 position, int reach, std::vector<uint32_t>& patches) const;

 private:
  /// Where a voxel's parts lie; `count` 0: free.
  struct Slot {
    uint64_t voxel = 0;
    uint32_t first = 0, count = 0;
  };
  /// The slot of a voxel, or the free one where it would be.
  size_t slot_of(uint64_t voxel) const;
  std::span<const Part> parts_in(uint64_t voxel) const;
  bool is_covered_at(const PatchPoint& at, uint32_t material, std::span<const Part> parts,
                     const trace::RayTracer& tracer) const;
  const Part* part_at(const PatchPoint& at, uint32_t material, std::span<const Part> parts,
                      const trace::RayTracer& tracer) const;

  VoxelGrid grid_;
  std::vector<Slot> slots_;  ///< a power of two of them, more than half of them free
  std::vector<Part> parts_;  ///< voxel by voxel
};

}  // namespace luxel::matrix
