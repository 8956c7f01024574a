#include "solve/gather/element_rays.h"

#include <algorithm>
#include <cmath>

#include "base/circle.h"
#include "base/random.h"
#include "base/vectorize.h"
#include "base/warp.h"
#include "transport/surroundings.h"

namespace luxel::gather {
namespace {

/// The cell of each point.
LUXEL_VECTOR_CLONES
void find_cells(const float* u, const float* v, uint8_t* cell, size_t count) {
  for (size_t i = 0; i < count; ++i) {
    const int a = int(u[i] * kCellsPerAxis), b = int(v[i] * kCellsPerAxis);
    cell[i] =
        uint8_t((a & 1) | (a & 2) << 1 | (a & 4) << 2 | (b & 1) << 1 | (b & 2) << 2 | (b & 4) << 3);
  }
}

/// Directions about +z from points of the unit square.
LUXEL_VECTOR_CLONES
void local_directions(const float* u, const float* v, float* x, float* y, float* z, size_t count) {
  for (size_t i = 0; i < count; ++i) {
    const Vec2 circle = unit_circle(u[i]);
    const float r = std::sqrt(v[i]);
    x[i] = circle.x * r, y[i] = circle.y * r, z[i] = std::sqrt(1 - v[i]);
  }
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
    return bent ? transport::mirrored_above(d, geometric_normal) : d;
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

std::array<Cone, kCells> cell_cones() {
  // The farthest from the middle is on the border; between its points it bulges by less than this.
  constexpr int kSteps = 16;
  constexpr float kMargin_rad = 0.02f;
  std::array<Cone, kCells> out;
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
    out[c] = {axis, std::cos(angle), std::sin(angle)};
  }
  return out;
}

// In the order of their cells: a counting sort.
void find_ray_cells(uint64_t seed, Samples samples, RayBatch& batch) {
  const uint32_t count = samples.count();
  batch.u.resize(count), batch.v.resize(count), batch.cell_of_point.resize(count);
  batch.rays.resize(count), batch.sample.resize(count), batch.cell.resize(count);
  batch.point.resize(count);
  sobol_owen_2d_points(seed, batch.u, batch.v, samples.first);
  find_cells(batch.u.data(), batch.v.data(), batch.cell_of_point.data(), count);
  batch.first_of_cell = {};
  for (uint32_t i = 0; i < count; ++i) ++batch.first_of_cell[batch.cell_of_point[i] + 1];
  for (size_t c = 0; c < kCells; ++c) batch.first_of_cell[c + 1] += batch.first_of_cell[c];
}

void fill_samples_of(uint64_t cells, Samples samples, RayBatch& batch) {
  auto place = batch.first_of_cell;
  for (uint32_t i = 0; i < samples.count(); ++i) {
    const uint8_t cell = batch.cell_of_point[i];
    if (!(cells >> cell & 1)) continue;
    const uint32_t at = place[cell]++;
    batch.point[at] = i, batch.sample[at] = samples.first + i, batch.cell[at] = cell;
  }
}

void fill_samples(uint64_t seed, Samples samples, RayBatch& batch) {
  find_ray_cells(seed, samples, batch);
  fill_samples_of(~uint64_t(0), samples, batch);
}

void fill_directions(Vec3 origin, Vec3 normal, Vec3 geometric_normal,
                     std::span<const uint32_t> which, RayBatch& batch) {
  const size_t count = which.size();
  for (auto* buffer : {&batch.few_u, &batch.few_v, &batch.x, &batch.y, &batch.z})
    buffer->resize(count);
  for (size_t j = 0; j < count; ++j) {
    const uint32_t point = batch.point[which[j]];
    batch.few_u[j] = batch.u[point], batch.few_v[j] = batch.v[point];
  }
  local_directions(batch.few_u.data(), batch.few_v.data(), batch.x.data(), batch.y.data(),
                   batch.z.data(), count);
  const Turn turn(normal, geometric_normal);
  for (size_t j = 0; j < count; ++j)
    batch.rays[which[j]] = {origin, 0, turn({batch.x[j], batch.y[j], batch.z[j]}), INFINITY};
}

void fill_rays(Vec3 origin, Vec3 normal, Vec3 geometric_normal, uint64_t seed, Samples samples,
               RayBatch& batch) {
  const size_t count = samples.count();
  fill_samples(seed, samples, batch);
  for (std::vector<float>* buffer : {&batch.x, &batch.y, &batch.z}) buffer->resize(count);
  local_directions(batch.u.data(), batch.v.data(), batch.x.data(), batch.y.data(), batch.z.data(),
                   count);
  const Turn turn(normal, geometric_normal);
  for (size_t at = 0; at < count; ++at) {
    const uint32_t i = batch.point[at];
    batch.rays[at] = {origin, 0, turn({batch.x[i], batch.y[i], batch.z[i]}), INFINITY};
  }
}

void element_rays(Vec3 origin, Vec3 normal, Vec3 geometric_normal, uint64_t seed,
                  std::span<trace::Ray> rays) {
  RayBatch batch;
  fill_rays(origin, normal, geometric_normal, seed, {0, uint32_t(rays.size())}, batch);
  std::copy(batch.rays.begin(), batch.rays.end(), rays.begin());
}

}  // namespace luxel::gather
