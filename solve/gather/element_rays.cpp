#include "solve/gather/element_rays.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/random.h"
#include "base/vectorize.h"
#include "base/warp.h"
#include "transport/surroundings.h"

namespace luxel::gather {
namespace {

/// Directions are sorted by cells of the unit square, 8 x 8 in Morton order.
constexpr int kCellsPerAxis = 8;
constexpr size_t kCells = size_t(kCellsPerAxis * kCellsPerAxis);

/// cos and sin of 2 pi x for x in [0, 1), to 2e-7: each quarter turn by Taylor's series about its
/// middle. Without branches, so that loops over it become vector code, which std::sin prevents.
inline Vec2 unit_circle(float x) {
  const float turns = 4 * x;
  const int quadrant = int(turns);
  const float t = (turns - float(quadrant) - 0.5f) * (0.5f * kPi);  // [-pi/4, pi/4)
  const float t2 = t * t;
  const float s = t * (1 + t2 * (-1.0f / 6 + t2 * (1.0f / 120 + t2 * (-1.0f / 5040))));
  const float c = 1 + t2 * (-0.5f + t2 * (1.0f / 24 + t2 * (-1.0f / 720 + t2 * (1.0f / 40320))));
  const float h = 0.70710678f;
  const float cosine = h * (c - s), sine = h * (c + s);  // turned by the missing eighth
  const float a = (quadrant & 1) ? -sine : cosine, b = (quadrant & 1) ? cosine : sine;
  const float sign = (quadrant & 2) ? -1.0f : 1.0f;
  return {a * sign, b * sign};
}

/// Directions about +z from the points (u, v), and the cell of each point.
LUXEL_VECTOR_CLONES
void local_directions(RayBatch& batch, size_t count) {
  const float* u = batch.u.data();
  const float* v = batch.v.data();
  float* x = batch.x.data();
  float* y = batch.y.data();
  float* z = batch.z.data();
  for (size_t i = 0; i < count; ++i) {
    const Vec2 circle = unit_circle(u[i]);
    const float r = std::sqrt(v[i]);
    x[i] = circle.x * r, y[i] = circle.y * r, z[i] = std::sqrt(1 - v[i]);
  }
  uint8_t* cell = batch.cell.data();
  for (size_t i = 0; i < count; ++i) {
    const int a = int(u[i] * kCellsPerAxis), b = int(v[i] * kCellsPerAxis);
    cell[i] =
        uint8_t((a & 1) | (a & 2) << 1 | (a & 4) << 2 | (b & 1) << 1 | (b & 2) << 2 | (b & 4) << 3);
  }
}

}  // namespace

void RayBatch::resize(size_t samples) {
  for (std::vector<float>* buffer : {&u, &v, &x, &y, &z}) buffer->resize(samples);
  cell.resize(samples), sample.resize(samples), rays.resize(samples);
}

// In the order of their cells: a counting sort.
void fill_rays(Vec3 origin, Vec3 normal, Vec3 geometric_normal, uint64_t seed, Samples samples,
               RayBatch& batch) {
  const uint32_t count = samples.count();
  batch.resize(count);
  sobol_owen_2d_points(seed, batch.u, batch.v, samples.first);
  local_directions(batch, count);
  std::array<uint32_t, kCells + 1> place{};
  for (uint32_t i = 0; i < count; ++i) ++place[batch.cell[i] + 1];
  for (size_t c = 0; c < kCells; ++c) place[c + 1] += place[c];
  const Frame frame = frame_around(normal);
  const bool bent = !(normal == geometric_normal);
  for (uint32_t i = 0; i < count; ++i) {
    Vec3 d = frame.to_world({batch.x[i], batch.y[i], batch.z[i]});
    if (bent) d = transport::mirrored_above(d, geometric_normal);
    const uint32_t at = place[batch.cell[i]]++;
    batch.rays[at] = {origin, 0, d, INFINITY};
    batch.sample[at] = samples.first + i;
  }
}

void element_rays(Vec3 origin, Vec3 normal, Vec3 geometric_normal, uint64_t seed,
                  std::span<trace::Ray> rays) {
  RayBatch batch;
  fill_rays(origin, normal, geometric_normal, seed, {0, uint32_t(rays.size())}, batch);
  std::copy(batch.rays.begin(), batch.rays.end(), rays.begin());
}

}  // namespace luxel::gather
