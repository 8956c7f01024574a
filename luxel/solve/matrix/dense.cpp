#include "luxel/solve/matrix/dense.h"

#include <algorithm>
#include <functional>

#include "luxel/base/check.h"
#include "luxel/base/parallel.h"
#include "luxel/base/vectorize.h"
#include "luxel/solve/matrix/half.h"

#if LUXEL_X86_VECTORS
#include <immintrin.h>
#endif

namespace luxel::matrix {
namespace {

/// Rows that a task takes.
constexpr size_t kDenseRows = 16;
/// Halves that are made floats at a time: they stay in the nearest cache.
constexpr size_t kChunk = 1024;
constexpr size_t kDenseLanes = 8;

/// Adds what two rows of `n` numbers receive from three planes of light, `stride` apart, to
/// sums[row][channel]. Two rows share what is read of the light.
LUXEL_VECTOR_CLONES
void add_two_rows(const float* row0, const float* row1, size_t n, const float* plane, size_t stride,
                  float (*sums)[3]) {
  Float8 sum[2][3] = {};
  size_t j = 0;
  for (; j + kDenseLanes <= n; j += kDenseLanes) {
    Float8 f0, f1;
    load8(row0 + j, f0), load8(row1 + j, f1);
    for (size_t c = 0; c < 3; ++c) {
      Float8 b;
      load8(plane + c * stride + j, b);
      sum[0][c] += f0 * b, sum[1][c] += f1 * b;
    }
  }
  for (size_t c = 0; c < 3; ++c) {
    for (size_t l = 0; l < kDenseLanes; ++l) sums[0][c] += sum[0][c][l], sums[1][c] += sum[1][c][l];
    for (size_t k = j; k < n; ++k) {
      const float b = plane[c * stride + k];
      sums[0][c] += row0[k] * b, sums[1][c] += row1[k] * b;
    }
  }
}

#if LUXEL_X86_VECTORS
/// Adds the products of rows of halves as above.
__attribute__((target("avx2,f16c"))) void add_two_rows_f16c(const uint16_t* row0,
                                                            const uint16_t* row1, size_t n,
                                                            const float* plane, size_t stride,
                                                            float (*sums)[3]) {
  __m256 sum[2][3] = {};
  size_t j = 0;
  for (; j + kDenseLanes <= n; j += kDenseLanes) {
    const __m256 f0 = _mm256_cvtph_ps(_mm_loadu_si128((const __m128i*)(row0 + j)));
    const __m256 f1 = _mm256_cvtph_ps(_mm_loadu_si128((const __m128i*)(row1 + j)));
    for (size_t c = 0; c < 3; ++c) {
      const __m256 b = _mm256_loadu_ps(plane + c * stride + j);
      sum[0][c] = _mm256_add_ps(sum[0][c], _mm256_mul_ps(f0, b));
      sum[1][c] = _mm256_add_ps(sum[1][c], _mm256_mul_ps(f1, b));
    }
  }
  for (size_t c = 0; c < 3; ++c) {
    for (size_t l = 0; l < kDenseLanes; ++l) sums[0][c] += sum[0][c][l], sums[1][c] += sum[1][c][l];
    for (size_t k = j; k < n; ++k) {
      const float b = plane[c * stride + k];
      sums[0][c] += float_from_half(row0[k]) * b, sums[1][c] += float_from_half(row1[k]) * b;
    }
  }
}
#endif

/// Adds the products of rows of halves, a chunk at a time.
void add_two_rows(const uint16_t* row0, const uint16_t* row1, size_t n, const float* plane,
                  size_t stride, Instructions instructions, float (*sums)[3]) {
  for (size_t j = 0; j < n; j += kChunk) {
    const size_t count = std::min(kChunk, n - j);
#if LUXEL_X86_VECTORS
    if (instructions >= Instructions::avx2) {
      add_two_rows_f16c(row0 + j, row1 + j, count, plane + j, stride, sums);
      continue;
    }
#endif
    float chunk[2][kChunk];
    for (size_t k = 0; k < count; ++k)
      chunk[0][k] = float_from_half(row0[j + k]), chunk[1][k] = float_from_half(row1[j + k]);
    add_two_rows(chunk[0], chunk[1], count, plane + j, stride, sums);
  }
}

}  // namespace

Dense make_dense(const FormFactors& factors, Precision precision) {
  Dense out;
  const size_t n = factors.size();
  out.n = uint32_t(n);
  precision == Precision::single ? out.single.resize(n * n) : out.half.resize(n * n);
  for (size_t i = 0; i < n; ++i)
    for (uint64_t k = factors.first[i]; k < factors.first[i + 1]; ++k) {
      const size_t entry = i * n + factors.column[k];
      if (precision == Precision::single)
        out.single[entry] = factors.factor[k];
      else
        out.half[entry] = half_from_float(factors.factor[k]);
    }
  return out;
}

DenseScratch make_dense_scratch(size_t patches) {
  const size_t stride = (patches + 15) / 16 * 16;
  return {std::vector<float>(3 * stride), stride};
}

void split_channels(std::span<const Rgb> light, DenseScratch& scratch) {
  LUXEL_CHECK(scratch.stride >= light.size());
  float* plane = scratch.plane.data();
  for (size_t j = 0; j < light.size(); ++j) {
    plane[j] = light[j].x;
    plane[scratch.stride + j] = light[j].y;
    plane[2 * scratch.stride + j] = light[j].z;
  }
}

LUXEL_VECTOR_CLONES
float inner_product(const float* row, const float* plane, size_t n) {
  Float8 sum[4] = {};
  size_t j = 0;
  for (; j + 4 * kDenseLanes <= n; j += 4 * kDenseLanes)
    for (size_t v = 0; v < 4; ++v) {
      Float8 f, b;
      load8(row + j + v * kDenseLanes, f);
      load8(plane + j + v * kDenseLanes, b);
      sum[v] += f * b;
    }
  const Float8 all = (sum[0] + sum[1]) + (sum[2] + sum[3]);
  float out = 0;
  for (size_t l = 0; l < kDenseLanes; ++l) out += all[l];
  for (; j < n; ++j) out += row[j] * plane[j];
  return out;
}

void multiply(const Dense& m, std::span<const Rgb> radiosity, std::span<Rgb> irradiance,
              DenseScratch& scratch) {
  multiply(m, radiosity, irradiance, scratch, instructions());
}

void multiply(const Dense& m, std::span<const Rgb> radiosity, std::span<Rgb> irradiance,
              DenseScratch& scratch, Instructions instructions) {
  const size_t n = m.n;
  LUXEL_CHECK(radiosity.size() == n && irradiance.size() == n && scratch.stride >= n);
  split_channels(radiosity, scratch);
  const auto rows = [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; i += 2) {
      const size_t next = std::min(i + 1, end - 1);
      float sums[2][3] = {};
      const float* b = scratch.plane.data();
      if (m.half.empty())
        add_two_rows(m.single.data() + i * n, m.single.data() + next * n, n, b, scratch.stride,
                     sums);
      else
        add_two_rows(m.half.data() + i * n, m.half.data() + next * n, n, b, scratch.stride,
                     instructions, sums);
      irradiance[i] = {sums[0][0], sums[0][1], sums[0][2]};
      irradiance[next] = {sums[1][0], sums[1][1], sums[1][2]};
    }
  };
  parallel_for(n, kDenseRows, std::ref(rows));
}

uint64_t bytes_of(const Dense& m) { return 4 * m.single.size() + 2 * m.half.size(); }

}  // namespace luxel::matrix
