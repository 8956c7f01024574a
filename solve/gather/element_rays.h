// The rays that an element sends out, in the order in which they are traced.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/random.h"
#include "trace/ray_tracer.h"

namespace luxel::gather {

/// Which samples of an element.
struct Samples {
  uint32_t first = 0, end = 0;

  uint32_t count() const { return end - first; }
  /// Whether a sample belongs to the second half of all up to `end`.
  bool in_second_half(uint32_t sample) const { return 2 * sample >= end; }
};

/// Directions are sorted by cells of the unit square, 8 x 8 in Morton order.
inline constexpr int kCellsPerAxis = 8;
inline constexpr size_t kCells = size_t(kCellsPerAxis * kCellsPerAxis);

/// Rays of one element with the number of the sample that each belongs to; and buffers, reused from
/// element to element.
struct RayBatch {
  std::vector<trace::Ray> rays;
  std::vector<uint32_t> sample;
  std::vector<uint8_t> cell;  ///< of the unit square, per ray: rays are in the order of their cells
  std::vector<float> u, v, few_u, few_v, x, y, z;
  std::vector<uint8_t> cell_of_point;
  std::vector<uint32_t> point;  ///< per ray, of u and v
  std::array<uint32_t, kCells + 1>
      first_of_cell{};  ///< the first ray of each cell; and how many there are
};

/// Of an element's rays.
inline uint64_t seed_of_rays(uint64_t seed, size_t element) {
  return hash64(seed ^ 0x6a7e, element);
}

/// Cosine-distributed about `normal`, those below the triangle mirrored to above it; sorted so that
/// neighbours in a packet point in similar directions. A sample's ray is the same in any batch.
void fill_rays(Vec3 origin, Vec3 normal, Vec3 geometric_normal, uint64_t seed, Samples samples,
               RayBatch& batch);

/// Directions within an angle below a right one of `axis`.
struct Cone {
  Vec3 axis{0, 0, 1};
  float cosine = 0, sine = 1;  ///< of that angle

  bool may_meet(const Cone& other) const {
    return dot(axis, other.axis) >= cosine * other.cosine - sine * other.sine;
  }
};
/// What holds the directions of each cell, about the normal +z.
std::array<Cone, kCells> cell_cones();

/// The same rays in the same order, but without directions: fill_directions() gives them to some.
void fill_samples(uint64_t seed, Samples samples, RayBatch& batch);
/// The same in two steps, for the rays of some cells only, one bit each: the first finds
/// batch.first_of_cell.
void find_ray_cells(uint64_t seed, Samples samples, RayBatch& batch);
void fill_samples_of(uint64_t cells, Samples samples, RayBatch& batch);
/// Gives rays[k] for each k of `which`, ascending, what fill_rays() gives it.
void fill_directions(Vec3 origin, Vec3 normal, Vec3 geometric_normal,
                     std::span<const uint32_t> which, RayBatch& batch);

/// The same for the first rays.size() samples. Shared with `luxel bench rays`.
void element_rays(Vec3 origin, Vec3 normal, Vec3 geometric_normal, uint64_t seed,
                  std::span<trace::Ray> rays);

}  // namespace luxel::gather
