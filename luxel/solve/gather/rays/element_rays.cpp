#include "luxel/solve/gather/rays/element_rays.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "luxel/base/both_directions.h"
#include "luxel/base/sobol_eighths.h"
#include "luxel/base/vectorize.h"
#include "luxel/base/warp.h"
#include "luxel/light/surroundings.h"

namespace luxel::gather {
namespace {

/// The number of the cell in column x and row y.
size_t cell_at(SobolEighth at) {
  const auto spread = [](size_t bits) { return (bits & 1) | (bits & 2) << 1 | (bits & 4) << 2; };
  return spread(at.x) | spread(at.y) << 1;
}

/// Directions about +z from points of the unit square.
LUXEL_VECTOR_CLONES
void local_directions(const float* u, const float* v, float* x, float* y, float* z, size_t count) {
  for (size_t i = 0; i < count; ++i) {
    const Vec3 d = both::cosine_direction(u[i], v[i]);
    x[i] = d.x, y[i] = d.y, z[i] = d.z;
  }
}

/// Those of samples of the batch, into its x, y and z.
void directions_of(std::span<const uint32_t> samples, RayBatch& batch) {
  for (auto* buffer : {&batch.u, &batch.v, &batch.x, &batch.y, &batch.z})
    buffer->resize(samples.size());
  sobol_owen_2d_points(batch.seed, samples, batch.u, batch.v);
  local_directions(batch.u.data(), batch.v.data(), batch.x.data(), batch.y.data(), batch.z.data(),
                   samples.size());
}

/// From such to the world.
struct Turn {
  Frame frame;
  Vec3 geometric_normal;
  bool bent;

  Turn(Vec3 normal, Vec3 geometric)
      : frame(frame_around(normal)),
        geometric_normal(geometric),
        bent(!(normal == geometric_normal)) {}
  Vec3 operator()(Vec3 local) const {
    const Vec3 d = frame.to_world(local);
    return bent ? light::mirrored_above(d, geometric_normal) : d;
  }
};

/// The direction of a point of a cell, whose number gives its place.
Vec3 direction_in(size_t cell, float across, float along) {
  const auto bits = [&](size_t first) {
    return (cell >> first & 1) | (cell >> (first + 1) & 2) | (cell >> (first + 2) & 4);
  };
  const float u = (float(bits(0)) + across) / kCellsPerAxis;
  const float v = (float(bits(1)) + along) / kCellsPerAxis;
  const float r = std::sqrt(v);
  return {r * std::cos(2 * kPi * u), r * std::sin(2 * kPi * u), std::sqrt(1 - v)};
}

}  // namespace

// A counting sort.
void sort_by_plain_cell(Samples samples, PlainCells& out) {
  out.of = samples, out.first_of = {}, out.sample.resize(samples.count());
  for (uint32_t s = samples.first; s < samples.end; ++s)
    ++out.first_of[cell_at(sobol_eighth(s)) + 1];
  for (size_t c = 0; c < kCells; ++c) out.first_of[c + 1] += out.first_of[c];
  auto place = out.first_of;
  for (uint32_t s = samples.first; s < samples.end; ++s)
    out.sample[place[cell_at(sobol_eighth(s))]++] = s;
}

CellCones cell_cones() {
  // The farthest from the middle is on the border; between its points it bulges by less than this.
  constexpr int kSteps = 16;
  constexpr float kMargin_rad = 0.02f;
  CellCones out;
  for (size_t c = 0; c < kCells; ++c) {
    const Vec3 axis = direction_in(c, 0.5f, 0.5f);
    float cosine = 1;
    for (int k = 0; k <= kSteps; ++k)
      for (const float side : {0.0f, 1.0f}) {
        const float at = float(k) / kSteps;
        cosine = std::min(
            {cosine, dot(axis, direction_in(c, at, side)), dot(axis, direction_in(c, side, at))});
      }
    const float angle = std::acos(std::clamp(cosine, -1.0f, 1.0f)) + kMargin_rad;
    out.x[c] = axis.x, out.y[c] = axis.y, out.z[c] = axis.z;
    out.cosine[c] = std::cos(angle), out.sine[c] = std::sin(angle);
  }
  return out;
}

LUXEL_VECTOR_CLONES
uint64_t cells_that_meet(const CellCones& cells, const Cone& cone) {
  const Vec3 axis = cone.axis;
  const float cosine = cone.cosine, sine = cone.sine;
  std::array<uint8_t, kCells> meets;
  for (size_t c = 0; c < kCells; ++c)
    meets[c] = cells.x[c] * axis.x + cells.y[c] * axis.y + cells.z[c] * axis.z >=
               cells.cosine[c] * cosine - cells.sine[c] * sine;
  uint64_t out = 0;
  for (size_t c = 0; c < kCells; c += 8) {
    // Eight bytes of 0 or 1 become bits: the product's top byte has each of them once.
    uint64_t eight = 0;
    for (size_t k = 0; k < 8; ++k) eight |= uint64_t(meets[c + k]) << (8 * k);
    out |= eight * 0x0102040810204080ull >> 56 << c;
  }
  return out;
}

size_t RayBatch::cell_of(uint32_t k) const {
  return size_t(std::ranges::upper_bound(first_of_cell, k) - first_of_cell.begin()) - 1;
}

namespace {

/// The plain cell that scrambling moves to each cell.
std::array<uint8_t, kCells> plain_cells(uint64_t seed) {
  const SobolEighths to = sobol_owen_eighths(seed);
  std::array<uint8_t, kCells> out;
  for (uint8_t x = 0; x < kCellsPerAxis; ++x)
    for (uint8_t y = 0; y < kCellsPerAxis; ++y)
      out[cell_at({to.x[x], to.y[y]})] = uint8_t(cell_at({x, y}));
  return out;
}

}  // namespace

void find_ray_cells(uint64_t seed, Samples samples, RayBatch& batch) {
  if (!(batch.plain.of == samples)) sort_by_plain_cell(samples, batch.plain);
  batch.seed = seed, batch.doublings.clear();
  batch.rays.resize(samples.count()), batch.sample.resize(samples.count());
  batch.plain_of_cell = plain_cells(seed);
  const auto& first = batch.plain.first_of;
  for (size_t c = 0; c < kCells; ++c) {
    const size_t plain = batch.plain_of_cell[c];
    batch.first_of_cell[c + 1] = batch.first_of_cell[c] + first[plain + 1] - first[plain];
  }
}

void fill_samples_of(uint64_t cells, RayBatch& batch) {
  const PlainCells& plain = batch.plain;
  for (; cells != 0; cells &= cells - 1) {
    const auto c = size_t(std::countr_zero(cells));
    const uint32_t* from = plain.sample.data() + plain.first_of[batch.plain_of_cell[c]];
    std::copy_n(from, batch.first_of_cell[c + 1] - batch.first_of_cell[c],
                batch.sample.data() + batch.first_of_cell[c]);
  }
}

void fill_samples(uint64_t seed, Samples samples, RayBatch& batch) {
  find_ray_cells(seed, samples, batch);
  fill_samples_of(~uint64_t(0), batch);
}

void fill_directions(Vec3 origin, Vec3 normal, Vec3 geometric_normal,
                     std::span<const uint32_t> which, RayBatch& batch) {
  batch.few.resize(which.size());
  for (size_t j = 0; j < which.size(); ++j) batch.few[j] = batch.sample[which[j]];
  directions_of(batch.few, batch);
  const Turn turn(normal, geometric_normal);
  for (size_t j = 0; j < which.size(); ++j)
    batch.rays[which[j]] = {origin, 0, turn({batch.x[j], batch.y[j], batch.z[j]}), INFINITY};
}

namespace {

/// Gives the samples of the batch their rays.
void fill_all_directions(Vec3 origin, Vec3 normal, Vec3 geometric_normal, RayBatch& batch) {
  directions_of(batch.sample, batch);
  const Turn turn(normal, geometric_normal);
  for (size_t k = 0; k < batch.rays.size(); ++k)
    batch.rays[k] = {origin, 0, turn({batch.x[k], batch.y[k], batch.z[k]}), INFINITY};
}

}  // namespace

void fill_rays(Vec3 origin, Vec3 normal, Vec3 geometric_normal, uint64_t seed, Samples samples,
               RayBatch& batch) {
  fill_samples(seed, samples, batch);
  fill_all_directions(origin, normal, geometric_normal, batch);
}

float CellShares::rays_per_sample() const {
  uint32_t sum = 0;
  for (const uint8_t k : doublings) sum += 1u << k;
  return float(sum) / float(kCells);
}

void fill_rays(Vec3 origin, Vec3 normal, Vec3 geometric_normal, uint64_t seed, Samples samples,
               const CellShares& shares, RayBatch& batch) {
  batch.seed = seed, batch.sample.clear(), batch.doublings.clear();
  batch.plain_of_cell = plain_cells(seed);
  for (size_t c = 0; c < kCells; ++c) {
    const uint8_t doublings = shares.doublings[c];
    PlainCells& plain = batch.plain_doubled[doublings];
    const Samples doubled = samples.doubled(doublings);
    if (!(plain.of == doubled)) sort_by_plain_cell(doubled, plain);
    const size_t from = plain.first_of[batch.plain_of_cell[c]],
                 to = plain.first_of[size_t(batch.plain_of_cell[c]) + 1];
    batch.sample.insert(batch.sample.end(), plain.sample.begin() + std::ptrdiff_t(from),
                        plain.sample.begin() + std::ptrdiff_t(to));
    batch.doublings.resize(batch.sample.size(), doublings);
    batch.first_of_cell[c + 1] = uint32_t(batch.sample.size());
  }
  batch.rays.resize(batch.sample.size());
  fill_all_directions(origin, normal, geometric_normal, batch);
}

void element_rays(Vec3 origin, Vec3 normal, Vec3 geometric_normal, uint64_t seed,
                  std::span<trace::Ray> rays) {
  RayBatch batch;
  fill_rays(origin, normal, geometric_normal, seed, {0, uint32_t(rays.size())}, batch);
  std::copy(batch.rays.begin(), batch.rays.end(), rays.begin());
}

}  // namespace luxel::gather
