// The rays that an element sends out, in the order in which they are traced.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "luxel/base/random.h"
#include "luxel/trace/ray_tracer.h"

namespace luxel::gather {

/// A range of an element's samples.
struct Samples {
  uint32_t first = 0, end = 0;

  friend bool operator==(const Samples&, const Samples&) = default;
  uint32_t count() const { return end - first; }
  /// Those of a cell with 2^doublings as many.
  Samples doubled(uint32_t doublings) const { return {first << doublings, end << doublings}; }
  /// A sample belongs to the second half of all up to `end`.
  bool in_second_half(uint32_t sample) const { return 2 * sample >= end; }
};

/// Directions are sorted by cells of the unit square, 8 x 8 in Morton order.
inline constexpr int kCellsPerAxis = 8;
inline constexpr size_t kCells = size_t(kCellsPerAxis * kCellsPerAxis);

/// Samples of each cell: 2^doublings times as many as with equal parts for all cells. A cell's mean
/// stands for the same part of the hemisphere, however many there are.
struct CellShares {
  std::array<uint8_t, kCells> doublings{};

  /// Rays of all cells for a sample.
  float rays_per_sample() const;
};
inline constexpr int kMostDoublings = 7;  ///< StoredHit has three bits for them

/// Samples by the cell in which they lie before they are scrambled, which is the same for all
/// elements.
struct PlainCells {
  Samples of{};
  std::vector<uint32_t> sample;                 ///< cell after cell, ascending within one
  std::array<uint32_t, kCells + 1> first_of{};  ///< the first of each cell
};

/// Sorts them, ascending within each cell.
void sort_by_plain_cell(Samples samples, PlainCells& out);

/// Rays of one element with the number of the sample that each belongs to; and buffers, reused from
/// element to element.
struct RayBatch {
  std::vector<trace::Ray> rays;  ///< in the order of their cells
  std::vector<uint32_t> sample;
  std::array<uint32_t, kCells + 1>
      first_of_cell{};  ///< the first ray of each cell; and how many there are
  uint64_t seed = 0;    ///< of the samples
  PlainCells plain;
  std::vector<uint8_t> doublings;  ///< of each ray's cell; empty: cells have equal shares
  std::array<PlainCells, kMostDoublings + 1> plain_doubled;  ///< with 2^k times the samples
  std::array<uint8_t, kCells> plain_of_cell{};  ///< which of them scrambling moves to each cell
  std::vector<uint32_t> few;                    ///< buffer: samples of some rays
  std::vector<float> u, v, x, y, z;  ///< buffers: points of the square, directions about +z

  /// The cell of the k-th ray.
  size_t cell_of(uint32_t k) const;
  uint32_t doublings_of(size_t k) const { return doublings.empty() ? 0 : doublings[k]; }
  /// The weight of the k-th ray: 2^-doublings.
  float weight_of(size_t k) const { return std::ldexp(1.0f, -int(doublings_of(k))); }
  /// True: the k-th ray belongs to the second half of its cell's samples. `samples`: of the
  /// element.
  bool in_second_half(size_t k, Samples samples) const {
    return samples.doubled(doublings_of(k)).in_second_half(sample[k]);
  }
};

/// The base of the seeds of all elements' rays.
inline uint64_t seed_of_all_rays(uint64_t seed) { return seed ^ 0x6a7e; }
/// The seed of those that follow a guide: it sets their directions apart from those that told where
/// to look.
inline uint64_t seed_of_guided_rays(uint64_t seed) { return hash64(seed, 0x9a1de); }
/// The seed of an element's rays.
inline uint64_t seed_of_rays(uint64_t seed, size_t element) {
  return hash64(seed_of_all_rays(seed), element);
}

/// Cosine-distributed about `normal`, those below the triangle mirrored to above it; sorted so that
/// neighbours in a packet point in similar directions. A sample's ray is the same in any batch.
void fill_rays(Vec3 origin, Vec3 normal, Vec3 geometric_normal, uint64_t seed, Samples samples,
               RayBatch& batch);

/// fill_rays() with as many samples in each cell as the shares say: of a cell's samples, the first
/// ones.
void fill_rays(Vec3 origin, Vec3 normal, Vec3 geometric_normal, uint64_t seed, Samples samples,
               const CellShares& shares, RayBatch& batch);

/// Directions within an angle below a right one of `axis`.
struct Cone {
  Vec3 axis{0, 0, 1};
  float cosine = 0, sine = 1;  ///< of that angle
};
/// A cone for each cell that holds its directions, about the normal +z.
struct CellCones {
  std::array<float, kCells> x{}, y{}, z{};  ///< their axes
  std::array<float, kCells> cosine{}, sine{};
};
CellCones cell_cones();
/// The cells that may have directions of the cone, one bit each.
uint64_t cells_that_meet(const CellCones& cells, const Cone& cone);

/// The rays of fill_rays() in its order, but without directions: fill_directions() gives them to
/// some.
void fill_samples(uint64_t seed, Samples samples, RayBatch& batch);
/// fill_samples() in two steps, for the rays of some cells only, one bit each: the first finds
/// batch.first_of_cell.
void find_ray_cells(uint64_t seed, Samples samples, RayBatch& batch);
void fill_samples_of(uint64_t cells, RayBatch& batch);
/// Gives rays[k] for each k of `which`, ascending, what fill_rays() gives it.
void fill_directions(Vec3 origin, Vec3 normal, Vec3 geometric_normal,
                     std::span<const uint32_t> which, RayBatch& batch);

/// The rays of fill_rays() for the first rays.size() samples. Shared with `luxel bench rays`.
void element_rays(Vec3 origin, Vec3 normal, Vec3 geometric_normal, uint64_t seed,
                  std::span<trace::Ray> rays);

}  // namespace luxel::gather
