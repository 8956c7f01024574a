#include "luxel/solve/matrix/reorder.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <numeric>

#include "luxel/base/check.h"
#include "luxel/base/parallel.h"
#include "luxel/base/random.h"
#include "luxel/base/vectorize.h"

namespace luxel::matrix {
namespace {

constexpr uint64_t kSeed = 0x7265f6f72d65721;

/// Squared distance.
LUXEL_VECTOR_CLONES
float distance2(const float* a, const float* b, size_t dimensions) {
  float sum[16] = {};
  size_t d = 0;
  for (; d + 16 <= dimensions; d += 16)
    for (size_t l = 0; l < 16; ++l) {
      const float difference = a[d + l] - b[d + l];
      sum[l] += difference * difference;
    }
  for (; d < dimensions; ++d) sum[0] += (a[d] - b[d]) * (a[d] - b[d]);
  return std::accumulate(sum, sum + 16, 0.0f);
}

/// Rows and dimensions that are projected together: as many sums as there are registers for.
constexpr size_t kProjectedRows = 4, kDimensions = 16, kProjectedLanes = 8;

/// sum_t pixel_t sign_t of four rows. `signs`: kDimensions per pixel and channel.
LUXEL_VECTOR_CLONES
void project_rows(const std::array<const uint8_t*, kProjectedRows>& row, size_t length, size_t step,
                  const float* signs, float (*out)[kDimensions]) {
  Float8 sum[kProjectedRows][2] = {};
  for (size_t t = 0; t < length; ++t)
    for (size_t c = 0; c < 3; ++c, signs += kDimensions) {
      Float8 sign[2];
      load8(signs, sign[0]), load8(signs + kProjectedLanes, sign[1]);
      for (size_t r = 0; r < kProjectedRows; ++r) {
        const auto value = float(row[r][4 * t * step + c]);
        sum[r][0] += value * sign[0], sum[r][1] += value * sign[1];
      }
    }
  std::memcpy(out, sum, sizeof sum);
}

}  // namespace

std::vector<uint32_t> greedy_order(std::span<const float> points, size_t dimensions,
                                   const Progress& progress) {
  LUXEL_CHECK(dimensions > 0 && points.size() % dimensions == 0);
  const size_t n = points.size() / dimensions;
  std::vector<uint32_t> order(n);
  std::iota(order.begin(), order.end(), 0u);
  // order[0, k) is the path, the rest what is left, ascending.
  for (size_t k = 1; k < n && !progress.cancelled(); ++k) {
    const float* here = points.data() + order[k - 1] * dimensions;
    size_t nearest = k;
    float least = INFINITY;
    for (size_t j = k; j < n; ++j) {
      const float d = distance2(here, points.data() + order[j] * dimensions, dimensions);
      if (d < least) least = d, nearest = j;
    }
    std::rotate(order.begin() + std::ptrdiff_t(k), order.begin() + std::ptrdiff_t(nearest),
                order.begin() + std::ptrdiff_t(nearest) + 1);
  }
  return order;
}

std::vector<float> project(const ByteRows& rows, const Progress& progress) {
  std::vector<float> out(rows.count * kProjected), signs(3 * rows.length * kDimensions);
  for (size_t first = 0; first < kProjected; first += kDimensions) {
    for (size_t k = 0; k < signs.size(); ++k)
      signs[k] = hash64(kSeed + first, k / 64) >> (k % 64) & 1 ? 1.0f : -1.0f;
    parallel_for(rows.count, kProjectedRows, [&](size_t begin, size_t end) {
      if (progress.cancelled()) return;
      std::array<const uint8_t*, kProjectedRows> row;
      for (size_t r = 0; r < kProjectedRows; ++r)
        row[r] = rows.data + 4 * std::min(begin + r, end - 1) * rows.row_step;
      float sums[kProjectedRows][kDimensions];
      project_rows(row, rows.length, rows.step, signs.data(), sums);
      for (size_t i = begin; i < end; ++i)
        std::copy_n(sums[i - begin], kDimensions, out.data() + i * kProjected + first);
    });
  }
  return out;
}

}  // namespace luxel::matrix
