// The leading eigenvectors of the symmetric matrix, without the dense matrix.
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "luxel/base/check.h"
#include "luxel/base/parallel.h"
#include "luxel/base/random.h"
#include "luxel/base/vectorize.h"
#include "luxel/solve/matrix/lowrank.h"
#include "luxel/solve/matrix/tall_matrix.h"

namespace luxel::matrix {
namespace {

/// Columns beyond those wanted: the last ones that are wanted converge far faster with a few to
/// spare [Halko11, section 4.2].
constexpr uint32_t kSpare = 16;
/// Rows that a task takes.
constexpr size_t kSpectrumRows = 32;

/// to += s * from
LUXEL_VECTOR_CLONES
void add_row(float s, const float* from, size_t count, float* to) {
  for (size_t k = 0; k < count; ++k) to[k] += s * from[k];
}

/// S q.
Tall product(const FormFactors& factors, std::span<const float> root_area_m, const Tall& q,
             Progress& progress) {
  Tall out = Tall::Zero(q.rows(), q.cols());
  parallel_for(factors.size(), kSpectrumRows, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end && !progress.cancelled(); ++i) {
      const auto columns = factors.columns_of(i);
      const auto values = factors.factors_of(i);
      for (size_t k = 0; k < columns.size(); ++k)
        add_row(values[k] * root_area_m[i] / root_area_m[columns[k]],
                q.row(Eigen::Index(columns[k])).data(), size_t(q.cols()),
                out.row(Eigen::Index(i)).data());
    }
    progress.advance(end - begin);
  });
  return out;
}

Tall random_columns(size_t rows, size_t columns, uint64_t seed) {
  Tall out{Eigen::Index(rows), Eigen::Index(columns)};
  RandomStream random{seed};
  for (Eigen::Index k = 0; k < out.size(); ++k) out.data()[k] = 2 * random.next() - 1;
  return out;
}

double energy_of(const FormFactors& factors, std::span<const float> area_m2) {
  double sum = 0;
  for (size_t i = 0; i < factors.size(); ++i) {
    const auto columns = factors.columns_of(i);
    const auto values = factors.factors_of(i);
    for (size_t k = 0; k < columns.size(); ++k)
      sum +=
          double(values[k]) * double(values[k]) * double(area_m2[i]) / double(area_m2[columns[k]]);
  }
  return sum;
}

/// The eigenvectors of S within the basis q (Rayleigh and Ritz), image = S q.
void append_pairs(const Tall& q, const Tall& image, size_t wanted, const Progress& progress,
                  Spectrum& out) {
  if (q.cols() == 0) return;
  const Eigen::MatrixXd inner = inner_products(q, image, progress);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(0.5 * (inner + inner.transpose()));
  std::vector<Eigen::Index> order(size_t(inner.rows()));
  std::iota(order.begin(), order.end(), Eigen::Index(0));
  std::stable_sort(order.begin(), order.end(), [&](Eigen::Index a, Eigen::Index b) {
    return std::abs(solver.eigenvalues()[a]) > std::abs(solver.eigenvalues()[b]);
  });
  order.resize(std::min(order.size(), wanted));
  Eigen::MatrixXd turn(inner.rows(), Eigen::Index(order.size()));
  for (size_t k = 0; k < order.size(); ++k) {
    turn.col(Eigen::Index(k)) = solver.eigenvectors().col(order[k]);
    out.value.push_back(float(solver.eigenvalues()[order[k]]));
  }
  const Tall vectors = combine(q, turn, progress);
  out.vector.assign(vectors.data(), vectors.data() + vectors.size());
}

}  // namespace

Result<Spectrum> spectrum_of(const FormFactors& factors, std::span<const float> area_m2,
                             const SpectrumParams& params, Progress& progress) {
  LUXEL_CHECK(area_m2.size() == factors.size() && params.iterations >= 0);
  if (params.count == 0)
    return fail(ErrorCode::bad_setting, "a rank of 0 holds no light; ask for 1 or more");
  const size_t n = factors.size();
  std::vector<float> root_area_m;
  for (const float area : area_m2) root_area_m.push_back(std::sqrt(area));
  progress.begin("spectrum", n * uint64_t(params.iterations + 2));
  Spectrum out;
  out.energy = energy_of(factors, area_m2);
  const auto product_of = [&](const Tall& q) { return product(factors, root_area_m, q, progress); };
  Tall q = random_columns(n, std::min(n, size_t(params.count) + kSpare), params.seed);
  for (int k = 0; k <= params.iterations && !progress.cancelled(); ++k)
    q = orthonormal(product_of(q), progress);
  if (!progress.cancelled()) append_pairs(q, product_of(q), params.count, progress, out);
  LUXEL_TRY_STATUS(stopped(progress));
  return out;
}

double lost(const Spectrum& spectrum, size_t rank) {
  if (spectrum.energy <= 0) return 0;
  double kept = 0;
  for (size_t k = 0; k < std::min(rank, spectrum.count()); ++k)
    kept += double(spectrum.value[k]) * double(spectrum.value[k]);
  return std::sqrt(std::max(0.0, 1 - kept / spectrum.energy));
}

size_t rank_above(const Spectrum& spectrum, float smallest) {
  return size_t(std::count_if(spectrum.value.begin(), spectrum.value.end(),
                              [&](float v) { return std::abs(v) >= smallest; }));
}

}  // namespace luxel::matrix
