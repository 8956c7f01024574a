#include "luxel/solve/matrix/lowrank.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "luxel/base/check.h"
#include "luxel/base/parallel.h"
#include "luxel/base/vectorize.h"
#include "luxel/solve/matrix/tall_matrix.h"

namespace luxel::matrix {
namespace {

/// Patches whose sums are kept apart.
constexpr size_t kPatches = 512;
/// Rows of small matrices, and patches, that a task takes.
constexpr size_t kLowrankRows = 64;

constexpr float kLargest = 32767;

/// Eigenvectors in 16 bits each of its largest entry, and that entry's size per step. Returns them
/// as they are kept, for sums.
Tall quantise(const Spectrum& spectrum, size_t rank, LowRank& out, std::vector<double>& step) {
  const size_t n = out.size(), padded = (rank + kRankLanes - 1) / kRankLanes * kRankLanes;
  out.vector.assign(n * padded, 0);
  step.assign(padded, 0);
  Tall kept = Tall::Zero(Eigen::Index(n), Eigen::Index(padded));
  for (size_t k = 0; k < rank; ++k) {
    float largest = 0;
    for (size_t i = 0; i < n; ++i)
      largest = std::max(largest, std::abs(spectrum.vector[i * spectrum.count() + k]));
    LUXEL_CHECK(largest > 0);
    step[k] = double(largest / kLargest);
    for (size_t i = 0; i < n; ++i) {
      const float v = std::round(spectrum.vector[i * spectrum.count() + k] * (kLargest / largest));
      out.vector[i * padded + k] = int16_t(v);
      kept(Eigen::Index(i), Eigen::Index(k)) = v;
    }
  }
  return kept;
}

/// C = (L^-1 - M)^-1 = L (I - M L)^-1, which needs no division by small eigenvalues. In units of
/// unit vectors, so that pivots are of about the same size.
std::vector<float> response_of(const Eigen::MatrixXd& reflected, std::span<const double> step,
                               const LowRank& matrix) {
  const Eigen::Index r = reflected.rows();
  if (r == 0) return {};
  const Eigen::Map<const Eigen::VectorXd> unit(step.data(), r);
  Eigen::VectorXd value(r);
  for (Eigen::Index k = 0; k < r; ++k)
    value[k] = step[size_t(k)] > 0
                   ? double(matrix.eigenvalue[size_t(k)]) / (step[size_t(k)] * step[size_t(k)])
                   : 0.0;
  const Eigen::MatrixXd m = unit.asDiagonal() * reflected * unit.asDiagonal();
  const Eigen::MatrixXd system =
      Eigen::MatrixXd::Identity(r, r) - value.asDiagonal() * m;  // transposed: C is symmetric
  const Eigen::MatrixXd all = system.partialPivLu().solve(Eigen::MatrixXd(value.asDiagonal()));
  const Eigen::MatrixXd scaled = unit.asDiagonal() * all * unit.asDiagonal();
  std::vector<float> out;
  for (Eigen::Index a = 0; a < r; ++a)
    for (Eigen::Index b = 0; b < r; ++b) out.push_back(float(0.5 * (scaled(a, b) + scaled(b, a))));
  return out;
}

}  // namespace

Result<LowRank> make_low_rank(const Spectrum& spectrum, size_t rank, std::span<const float> area_m2,
                              std::span<const Rgb> reflectance, Progress& progress) {
  LUXEL_CHECK(rank <= spectrum.count() && reflectance.size() == area_m2.size());
  for (const Rgb& rho : reflectance) LUXEL_CHECK(min_component(rho) >= 0 && max_component(rho) < 1);
  LUXEL_CHECK(spectrum.vector.size() == area_m2.size() * spectrum.count());
  LowRank out;
  for (const float area : area_m2) out.root_area_m.push_back(std::sqrt(area));
  std::vector<double> step;
  const Tall kept = quantise(spectrum, rank, out, step);
  for (size_t k = 0; k < step.size(); ++k)
    out.eigenvalue.push_back(k < rank ? float(double(spectrum.value[k]) * step[k] * step[k]) : 0);
  progress.begin("bounces", 3);
  for (int channel = 0; channel < 3; ++channel) {
    Tall weighted = kept;
    for (size_t i = 0; i < out.size(); ++i)
      weighted.row(Eigen::Index(i)) *= reflectance[i][channel];
    const Eigen::MatrixXd reflected = inner_products(weighted, kept, progress);
    LUXEL_TRY_STATUS(stopped(progress));
    for (Eigen::Index k = 0; k < reflected.size(); ++k)
      out.reflected[size_t(channel)].push_back(float(reflected.data()[k]));
    out.all_bounces[size_t(channel)] = response_of(reflected, step, out);
    progress.advance(1);
  }
  return out;
}

LowRankScratch make_scratch(const LowRank& matrix) {
  LowRankScratch scratch;
  const size_t numbers = 3 * matrix.rank();
  scratch.partial.resize((matrix.size() + kPatches - 1) / kPatches * numbers);
  for (std::vector<float>* v : {&scratch.sent, &scratch.sum, &scratch.after}) v->resize(numbers);
  return scratch;
}

namespace {

/// sum = V^T A^1/2 B over the patches [begin, end).
LUXEL_VECTOR_CLONES
void gather(const LowRank& m, std::span<const Rgb> sent, size_t begin, size_t end, float* sum) {
  const size_t rank = m.rank();
  std::fill(sum, sum + 3 * rank, 0.0f);
  for (size_t i = begin; i < end; ++i) {
    const int16_t* v = m.vector.data() + i * rank;
    const Rgb b = sent[i] * m.root_area_m[i];
    for (size_t k = 0; k < rank; ++k) {
      const auto value = float(v[k]);
      sum[k] += value * b.x;
      sum[rank + k] += value * b.y;
      sum[2 * rank + k] += value * b.z;
    }
  }
}

/// The sum of a[k] b[k], in kRankLanes sums that one vector instruction each can take.
template <class Number>
inline float dot(const Number* a, const float* b, size_t count) {
  float lane[kRankLanes] = {};
  for (size_t k = 0; k < count; k += kRankLanes)
    for (size_t l = 0; l < kRankLanes; ++l) lane[l] += float(a[k + l]) * b[k + l];
  float sum = 0;
  for (const float v : lane) sum += v;
  return sum;
}

/// Rows [begin, end) of out = matrix x, channel by channel.
LUXEL_VECTOR_CLONES
void multiply_rows(const std::array<std::vector<float>, 3>& matrix, std::span<const float> x,
                   size_t begin, size_t end, std::span<float> out) {
  const size_t rank = x.size() / 3;
  for (size_t channel = 0; channel < 3; ++channel)
    for (size_t a = begin; a < end; ++a)
      out[channel * rank + a] =
          dot(matrix[channel].data() + a * rank, x.data() + channel * rank, rank);
}

void multiply_small(const std::array<std::vector<float>, 3>& matrix, std::span<const float> x,
                    std::span<float> out) {
  const auto rows = [&](size_t begin, size_t end) { multiply_rows(matrix, x, begin, end, out); };
  parallel_for(x.size() / 3, kLowrankRows, std::ref(rows));
}

/// A^-1/2 V x at the patches [begin, end).
LUXEL_VECTOR_CLONES
void scatter(const LowRank& m, std::span<const float> x, size_t begin, size_t end,
             std::span<Rgb> irradiance) {
  const size_t rank = m.rank();
  for (size_t i = begin; i < end; ++i) {
    const int16_t* v = m.vector.data() + i * rank;
    const Rgb sum{dot(v, x.data(), rank), dot(v, x.data() + rank, rank),
                  dot(v, x.data() + 2 * rank, rank)};
    irradiance[i] = max(sum / m.root_area_m[i], Rgb{});  // eigenvectors may fall below nothing
  }
}

/// scratch.sent = V^T A^1/2 B, by blocks in their order.
void send(const LowRank& m, std::span<const Rgb> sent, LowRankScratch& scratch) {
  const size_t numbers = 3 * m.rank(),
               blocks = scratch.partial.size() / std::max<size_t>(numbers, 1);
  const auto gather_blocks = [&](size_t begin, size_t end) {
    for (size_t block = begin; block < end; ++block)
      gather(m, sent, block * kPatches, std::min(m.size(), (block + 1) * kPatches),
             scratch.partial.data() + block * numbers);
  };
  parallel_for(blocks, 1, std::ref(gather_blocks));
  std::fill(scratch.sent.begin(), scratch.sent.end(), 0.0f);
  for (size_t block = 0; block < blocks; ++block)
    for (size_t k = 0; k < numbers; ++k) scratch.sent[k] += scratch.partial[block * numbers + k];
}

/// scratch.sum = x_bounces.
void count_products(const LowRank& m, int bounces, LowRankScratch& scratch) {
  const size_t rank = m.rank();
  std::fill(scratch.sum.begin(), scratch.sum.end(), 0.0f);
  for (int b = 0; b < bounces; ++b) {
    multiply_small(m.reflected, scratch.sum, scratch.after);
    for (size_t k = 0; k < scratch.sum.size(); ++k)
      scratch.sum[k] = m.eigenvalue[k % rank] * (scratch.sent[k] + scratch.after[k]);
  }
}

}  // namespace

void irradiance_of(const LowRank& m, std::span<const Rgb> sent, int bounces,
                   std::span<Rgb> irradiance, LowRankScratch& scratch) {
  LUXEL_CHECK(sent.size() == m.size() && irradiance.size() == m.size());
  LUXEL_CHECK(scratch.sent.size() == 3 * m.rank());
  send(m, sent, scratch);
  if (bounces < 0)
    multiply_small(m.all_bounces, scratch.sent, scratch.sum);
  else
    count_products(m, bounces, scratch);
  const auto back = [&](size_t begin, size_t end) {
    scatter(m, scratch.sum, begin, end, irradiance);
  };
  parallel_for(m.size(), kLowrankRows, std::ref(back));
}

uint64_t bytes_of(const LowRank& m) {
  uint64_t bytes = sizeof(float) * (m.root_area_m.size() + m.eigenvalue.size()) +
                   sizeof(int16_t) * m.vector.size();
  for (size_t channel = 0; channel < 3; ++channel)
    bytes += sizeof(float) * (m.reflected[channel].size() + m.all_bounces[channel].size());
  return bytes;
}

}  // namespace luxel::matrix
