// E = K B from blocks, 16 entries at a time.
#include <algorithm>
#include <cmath>
#include <functional>

#include "luxel/base/check.h"
#include "luxel/base/parallel.h"
#include "luxel/solve/matrix/bc1.h"
#include "luxel/solve/matrix/bc1_block.h"
#include "luxel/solve/matrix/half.h"
#include "luxel/solve/matrix/instructions.h"

#if LUXEL_X86_VECTORS
// GCC 12 takes its own undefined registers for uninitialised variables. [GCC bug 105593]
#ifndef __clang__
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif
#include <immintrin.h>
#endif

namespace luxel::matrix {
namespace {

/// Block rows that a task takes; their blocks first, then what is kept of them, so that each has
/// the nearest cache to itself.
constexpr size_t kBlockRows = 8;
constexpr size_t kBlockLanes = 16;
using Levels = Bc1Scratch::Levels;

/// Sums of a block row: entry k of a block in lane k.
struct Sums {
  alignas(64) float lane[3][kBlockLanes] = {};
};

/// Input of a product.
struct Input {
  const Levels *five = nullptr, *six = nullptr;
  const float* light = nullptr;  ///< three planes
  size_t stride = 0;
  const Levels* color = nullptr;
};

/// Both ends of a channel's colours, as an index into its levels.
inline size_t red_of(uint64_t block) { return (block >> 11 & 31) | (block >> 22 & 0x3e0); }
inline size_t green_of(uint64_t block) { return (block >> 5 & 63) | (block >> 15 & 0xfc0); }
inline size_t blue_of(uint64_t block) { return (block & 31) | (block >> 11 & 0x3e0); }

/// Adds two block rows, which share what is read of the light.
using AddBlocks = void(const std::array<const uint64_t*, 2>& row, size_t count, const Input& in,
                       std::array<Sums, 2>& sums);
/// sums[k % 4] += entry k times its light; the last lane is nothing.
using AddKept = void(const Bc1::Kept* kept, size_t count, const Levels* color,
                     std::array<Levels, 4>& sums);

void add_blocks_any(const std::array<const uint64_t*, 2>& row, size_t count, const Input& in,
                    std::array<Sums, 2>& sums) {
  for (size_t r = 0; r < 2; ++r)
    for (size_t b = 0; b < count; ++b) {
      const uint64_t block = row[r][b];
      const Levels* levels[3] = {in.five + red_of(block), in.six + green_of(block),
                                 in.five + blue_of(block)};
      for (size_t c = 0; c < 3; ++c)
        for (size_t k = 0; k < kBlockLanes; ++k)
          sums[r].lane[c][k] =
              std::fma((*levels[c])[block >> (32 + 2 * k) & 3],
                       in.light[c * in.stride + 4 * b + k % 4], sums[r].lane[c][k]);
    }
}

void add_kept_any(const Bc1::Kept* kept, size_t count, const Levels* color,
                  std::array<Levels, 4>& sums) {
  for (size_t k = 0; k < count; ++k)
    for (size_t c = 0; c < 3; ++c)
      sums[k % 4][c] =
          std::fma(float_from_half(kept[k].value[c]), color[kept[k].place][c], sums[k % 4][c]);
}

#if LUXEL_X86_VECTORS
#define LUXEL_AVX2 __attribute__((target("avx2,f16c,fma")))
#define LUXEL_AVX512 __attribute__((target("avx2,f16c,fma,bmi2,avx512f,avx512vl")))

LUXEL_AVX2 void add_blocks_avx2(const std::array<const uint64_t*, 2>& row, size_t count,
                                const Input& in, std::array<Sums, 2>& sums) {
  const __m256i low = _mm256_setr_epi32(0, 2, 4, 6, 8, 10, 12, 14);
  const __m256i high = _mm256_add_epi32(low, _mm256_set1_epi32(16));
  for (size_t r = 0; r < 2; ++r) {
    __m256 sum[3][2] = {};
    for (size_t b = 0; b < count; ++b) {
      const uint64_t block = row[r][b];
      const __m256i index = _mm256_set1_epi32(int(block >> 32));
      const __m256i index0 = _mm256_srlv_epi32(index, low), index1 = _mm256_srlv_epi32(index, high);
      const Levels* levels[3] = {in.five + red_of(block), in.six + green_of(block),
                                 in.five + blue_of(block)};
      for (size_t c = 0; c < 3; ++c) {
        const __m256 level = _mm256_broadcast_ps((const __m128*)levels[c]);
        const __m256 light = _mm256_broadcast_ps((const __m128*)(in.light + c * in.stride + 4 * b));
        sum[c][0] = _mm256_fmadd_ps(_mm256_permutevar_ps(level, index0), light, sum[c][0]);
        sum[c][1] = _mm256_fmadd_ps(_mm256_permutevar_ps(level, index1), light, sum[c][1]);
      }
    }
    for (size_t c = 0; c < 3; ++c) {
      _mm256_store_ps(sums[r].lane[c], sum[c][0]);
      _mm256_store_ps(sums[r].lane[c] + 8, sum[c][1]);
    }
  }
}

LUXEL_AVX2 void add_kept_avx2(const Bc1::Kept* kept, size_t count, const Levels* color,
                              std::array<Levels, 4>& sums) {
  __m128 sum[4] = {};
  // The place is read as a half, too, into the lane that is nothing.
  const auto add = [&](size_t k, __m128& to) LUXEL_AVX2 {
    const __m128 value = _mm_cvtph_ps(_mm_loadl_epi64((const __m128i*)(kept + k)));
    to = _mm_fmadd_ps(value, _mm_load_ps(color[kept[k].place].data()), to);
  };
  size_t k = 0;
  for (; k + 4 <= count; k += 4)
    for (size_t l = 0; l < 4; ++l) add(k + l, sum[l]);
  for (size_t l = 0; k + l < count; ++l) add(k + l, sum[l]);
  for (size_t l = 0; l < 4; ++l) _mm_store_ps(sums[l].data(), sum[l]);
}

/// pext gathers the ends' bits; 4 zeros below them make the index a distance in bytes.
LUXEL_AVX512 inline __m512 levels_at(const Levels* levels, uint64_t block, uint64_t mask) {
  const uint64_t offset = _pext_u64(block << 4, mask << 4 | 15);
  return _mm512_broadcast_f32x4(_mm_load_ps((const float*)((const char*)levels + offset)));
}

LUXEL_AVX512 void add_blocks_avx512(const std::array<const uint64_t*, 2>& row, size_t count,
                                    const Input& in, std::array<Sums, 2>& sums) {
  const __m512i shift =
      _mm512_setr_epi32(0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30);
  __m512 sum[2][3] = {};
  for (size_t b = 0; b < count; ++b) {
    __m512 light[3];
    for (size_t c = 0; c < 3; ++c)
      light[c] = _mm512_broadcast_f32x4(_mm_load_ps(in.light + c * in.stride + 4 * b));
    for (size_t r = 0; r < 2; ++r) {
      const uint64_t block = row[r][b];
      const __m512i index =
          _mm512_srlv_epi32(_mm512_set1_epi32(((const int*)(row[r] + b))[1]), shift);
      const __m512 red = levels_at(in.five, block, 0xf800f800);
      const __m512 green = levels_at(in.six, block, 0x07e007e0);
      const __m512 blue = levels_at(in.five, block, 0x001f001f);
      sum[r][0] = _mm512_fmadd_ps(_mm512_permutevar_ps(red, index), light[0], sum[r][0]);
      sum[r][1] = _mm512_fmadd_ps(_mm512_permutevar_ps(green, index), light[1], sum[r][1]);
      sum[r][2] = _mm512_fmadd_ps(_mm512_permutevar_ps(blue, index), light[2], sum[r][2]);
    }
  }
  for (size_t r = 0; r < 2; ++r)
    for (size_t c = 0; c < 3; ++c) _mm512_store_ps(sums[r].lane[c], sum[r][c]);
}
#endif

struct Kernels {
  AddBlocks* add_blocks = add_blocks_any;
  AddKept* add_kept = add_kept_any;
};

Kernels kernels_for(Instructions instructions) {
#if LUXEL_X86_VECTORS
  if (instructions == Instructions::avx512) return {add_blocks_avx512, add_kept_avx2};
  if (instructions == Instructions::avx2) return {add_blocks_avx2, add_kept_avx2};
#endif
  return {};
}

Rgb kept_light(const Bc1& m, size_t place, const Input& in, const Kernels& kernels) {
  alignas(16) std::array<Levels, 4> sums{};
  const uint32_t first = m.first_kept[place];
  kernels.add_kept(m.kept.data() + first, m.first_kept[place + 1] - first, in.color, sums);
  std::array<float, 3> out;
  for (size_t c = 0; c < 3; ++c)
    out[c] = ((sums[0][c] + sums[1][c]) + (sums[2][c] + sums[3][c])) * m.kept_unit[c];
  return {out[0], out[1], out[2]};
}

/// Rows of places [begin, end) of blocks, kBlockRows at most.
void multiply_block_rows(const Bc1& m, size_t begin, size_t end, const Input& in,
                         const Kernels& kernels, std::span<Rgb> irradiance) {
  std::array<std::array<Sums, 2>, kBlockRows / 2> sums{};
  const size_t wide = m.blocks_per_row();
  for (size_t r = begin; r < end; r += 2)
    kernels.add_blocks(
        {m.blocks.data() + r * wide, m.blocks.data() + std::min(r + 1, end - 1) * wide}, wide, in,
        sums[(r - begin) / 2]);
  for (size_t place = 4 * begin; place < std::min<size_t>(4 * end, m.n); ++place) {
    const size_t r = place / 4 - begin;
    std::array<float, 3> rest;
    for (size_t c = 0; c < 3; ++c) {
      const float* lane = sums[r / 2][r % 2].lane[c] + 4 * (place % 4);
      rest[c] = (lane[0] + lane[1]) + (lane[2] + lane[3]);
    }
    irradiance[m.row[place]] =
        m.row_scale[place] * Rgb{rest[0], rest[1], rest[2]} + kept_light(m, place, in, kernels);
  }
}

/// Values of all pairs of ends of 2^bits levels.
std::vector<Levels> levels_of(uint32_t bits, float log_range) {
  const std::array<float, 256> value = byte_values(log_range);
  const uint32_t count = 1u << bits;
  std::vector<Levels> out(size_t(count) * count);
  for (uint32_t b = 0; b < count; ++b)
    for (uint32_t a = 0; a < count; ++a) {
      const uint32_t low = a << (8 - bits) | a >> (2 * bits - 8);
      const uint32_t high = b << (8 - bits) | b >> (2 * bits - 8);
      out[b * count + a] = {value[low], value[high], value[(2 * low + high) / 3],
                            value[(low + 2 * high) / 3]};
    }
  return out;
}

}  // namespace

Bc1Scratch make_bc1_scratch(const Bc1& m) {
  return {levels_of(5, m.log_range), levels_of(6, m.log_range), make_dense_scratch(m.n),
          std::vector<Levels>(m.n)};
}

void multiply(const Bc1& m, std::span<const Rgb> radiosity, std::span<Rgb> irradiance,
              Bc1Scratch& scratch) {
  multiply(m, radiosity, irradiance, scratch, instructions());
}

void multiply(const Bc1& m, std::span<const Rgb> radiosity, std::span<Rgb> irradiance,
              Bc1Scratch& scratch, Instructions instructions) {
  LUXEL_CHECK(radiosity.size() == m.n && irradiance.size() == m.n && scratch.color.size() == m.n);
  const Input in{scratch.five.data(), scratch.six.data(), scratch.light.plane.data(),
                 scratch.light.stride, scratch.color.data()};
  for (size_t place = 0; place < m.n; ++place) {
    const Rgb b = m.column_scale[place] * radiosity[m.column[place]];
    scratch.color[place] = {b.x, b.y, b.z, 0};
    for (size_t c = 0; c < 3; ++c) scratch.light.plane[c * in.stride + place] = b[int(c)];
  }
  const Kernels kernels = kernels_for(instructions);
  const auto rows = [&](size_t begin, size_t end) {
    multiply_block_rows(m, begin, end, in, kernels, irradiance);
  };
  parallel_for(m.blocks_per_row(), kBlockRows, std::ref(rows));
}

}  // namespace luxel::matrix
