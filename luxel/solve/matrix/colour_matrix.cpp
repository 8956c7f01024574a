#include "luxel/solve/matrix/colour_matrix.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <functional>

#include "luxel/base/check.h"
#include "luxel/base/parallel.h"
#include "luxel/base/vectorize.h"
#include "luxel/solve/matrix/row_sums.h"

namespace luxel::matrix {
namespace {

/// Rows of a product that a task takes.
constexpr size_t kProductRows = 16;
/// Columns of K that are reflected together: as many sums as a processor has registers for.
constexpr size_t kPanel = 64;
constexpr size_t kColourLanes = 8;
/// Columns and rows of the blocks that the direct solution works on.
constexpr Eigen::Index kBlock = 256;

/// One row of some columns of a matrix; whole lines of the cache.
struct alignas(64) PanelRow {
  float value[kPanel] = {};
};
using Panel = std::vector<PanelRow>;

/// out += sum_k factor_k panel_(column k).
LUXEL_VECTOR_CLONES
void add_row(std::span<const uint32_t> column, std::span<const float> factor, const PanelRow* panel,
             float* out) {
  Float8 sum[kPanel / kColourLanes] = {};
  add_products(column, factor, panel, sum);
  for (size_t v = 0; v < kPanel / kColourLanes; ++v)
    for (size_t l = 0; l < kColourLanes; ++l) out[v * kColourLanes + l] += sum[v][l];
}

/// Columns [begin, end) of F.
Panel panel_of(const FormFactors& factors, size_t begin, size_t end) {
  Panel panel(factors.size());
  for (size_t i = 0; i < factors.size(); ++i) {
    const auto columns = factors.columns_of(i);
    const auto values = factors.factors_of(i);
    const auto from = std::lower_bound(columns.begin(), columns.end(), uint32_t(begin));
    for (auto k = size_t(from - columns.begin()); k < columns.size() && columns[k] < end; ++k)
      panel[i].value[columns[k] - begin] = values[k];
  }
  return panel;
}

/// K by Horner's rule, X <- F + F rho X, on columns [begin, end). A panel stays in the cache from
/// bounce to bounce, and F is sparse: doubling (S_2k = S_k + (F rho)^k S_k) would need fewer
/// products, but of dense matrices.
void reflect_panel(const FormFactors& factors, std::span<const Rgb> reflectance, int channel,
                   int bounces, size_t begin, size_t end, std::vector<float>& out) {
  const size_t n = factors.size();
  const Panel first = panel_of(factors, begin, end);
  Panel now = first, sent(n);
  for (int h = 1; h < bounces; ++h) {
    for (size_t i = 0; i < n; ++i)
      for (size_t j = 0; j < kPanel; ++j)
        sent[i].value[j] = reflectance[i][channel] * now[i].value[j];
    now = first;
    for (size_t i = 0; i < n; ++i)
      add_row(factors.columns_of(i), factors.factors_of(i), sent.data(), now[i].value);
  }
  for (size_t i = 0; i < n; ++i) std::copy_n(now[i].value, end - begin, out.data() + i * n + begin);
}

Status reflect(const FormFactors& factors, std::span<const Rgb> reflectance, int channel,
               int bounces, std::vector<float>& out, Progress& progress) {
  parallel_for(factors.size(), kPanel, [&](size_t begin, size_t end) {
    if (progress.cancelled()) return;
    reflect_panel(factors, reflectance, channel, bounces, begin, end, out);
    progress.advance(end - begin);
  });
  return stopped(progress);
}

using Matrix = Eigen::MatrixXf;

/// S' = sqrt(A) F / sqrt(A), which is symmetric.
Matrix symmetric_matrix(const FormFactors& factors, std::span<const float> area_m2) {
  const auto n = Eigen::Index(factors.size());
  Matrix out = Matrix::Zero(n, n);
  for (size_t i = 0; i < factors.size(); ++i)
    for (uint64_t k = factors.first[i]; k < factors.first[i + 1]; ++k) {
      const size_t j = factors.column[k];
      const double ratio = double(area_m2[i]) / double(area_m2[j]);
      out(Eigen::Index(i), Eigen::Index(j)) = float(double(factors.factor[k]) * std::sqrt(ratio));
    }
  return out;
}

/// Calls body(first, size) for blocks of [begin, n). Errors: cancelled.
Status for_blocks(Eigen::Index begin, Eigen::Index n, Progress& progress,
                  const std::function<void(Eigen::Index, Eigen::Index)>& body) {
  parallel_for(size_t(n - begin), size_t(kBlock), [&](size_t first, size_t end) {
    if (!progress.cancelled()) body(begin + Eigen::Index(first), Eigen::Index(end - first));
  });
  return stopped(progress);
}

/// The lower triangle of a matrix becomes L, L L^T = matrix; block column by block column.
Status factorise(Matrix& matrix, Progress& progress) {
  const Eigen::Index n = matrix.rows();
  for (Eigen::Index k = 0; k < n; k += kBlock) {
    const Eigen::Index wide = std::min(kBlock, n - k);
    const auto update = [&](Eigen::Index row, Eigen::Index rows) {
      matrix.block(row, k, rows, wide).noalias() -=
          matrix.block(row, 0, rows, k) * matrix.block(k, 0, wide, k).transpose();
    };
    LUXEL_TRY_STATUS(for_blocks(k, n, progress, update));
    const Eigen::LLT<Matrix> corner(matrix.block(k, k, wide, wide));
    if (corner.info() != Eigen::Success)
      return fail(ErrorCode::bad_input,
                  "infinite bounces do not converge: reflectances are nearly 1 in a closed scene; "
                  "lower them, or limit the bounces");
    matrix.block(k, k, wide, wide) = corner.matrixL();
    const auto solve = [&](Eigen::Index row, Eigen::Index rows) {
      auto block = matrix.block(row, k, rows, wide);
      corner.matrixU().solveInPlace<Eigen::OnTheRight>(block);
    };
    LUXEL_TRY_STATUS(for_blocks(k + wide, n, progress, solve));
  }
  return {};
}

/// Rows [row, row + rows) of columns [first, first + count) of K from those of sqrt(A) K / sqrt(A),
/// which is symmetric.
void store_tile(const Matrix& tile, Eigen::Index row, Eigen::Index first,
                std::span<const float> area_m2, std::vector<float>& out) {
  const size_t n = area_m2.size();
  for (Eigen::Index j = 0; j < tile.cols(); ++j)
    for (Eigen::Index i = 0; i < tile.rows(); ++i) {
      const auto a = size_t(row + i), b = size_t(first + j);
      const float ratio = std::sqrt(area_m2[b] / area_m2[a]);
      out[a * n + b] = tile(i, j) * ratio;
      if (a > b) out[b * n + a] = tile(i, j) / ratio;
    }
}

/// The limit. With S' and R = sqrt(rho),
///   sqrt(A) K / sqrt(A) = S' + S' R (1 + M + M^2 + ...) R S',   M = R S' R,
/// and 1 - M = L L^T is positive definite: M is similar to F rho, whose rows sum to less than 1. So
/// it is S' + Y^T Y with L Y = R S'.
Status reflect_for_ever(const Matrix& s, std::span<const Rgb> reflectance,
                        std::span<const float> area_m2, int channel, std::vector<float>& out,
                        Progress& progress) {
  const Eigen::Index n = s.rows();
  Eigen::VectorXf root(n);
  for (Eigen::Index i = 0; i < n; ++i) root[i] = std::sqrt(reflectance[size_t(i)][channel]);
  // L of 1 - M.
  Matrix y = root.asDiagonal() * s;
  Matrix l = -(y * root.asDiagonal());
  l.diagonal().array() += 1.0f;
  LUXEL_TRY_STATUS(factorise(l, progress));
  // Y, by columns.
  const auto solve = [&](Eigen::Index first, Eigen::Index count) {
    for (Eigen::Index k = 0; k < n && !progress.cancelled(); k += kBlock) {
      const Eigen::Index rows = std::min(kBlock, n - k);
      auto block = y.block(k, first, rows, count);
      block.noalias() -= l.block(k, 0, rows, k) * y.block(0, first, k, count);
      l.block(k, k, rows, rows).triangularView<Eigen::Lower>().solveInPlace(block);
    }
  };
  // S' + Y^T Y, tile by tile: the lower half, which stands for both.
  const auto sum = [&](Eigen::Index first, Eigen::Index count) {
    for (Eigen::Index row = first; row < n && !progress.cancelled(); row += kBlock) {
      const Eigen::Index rows = std::min(kBlock, n - row);
      const Matrix tile = s.block(row, first, rows, count) +
                          y.middleCols(row, rows).transpose() * y.middleCols(first, count);
      store_tile(tile, row, first, area_m2, out);
    }
    progress.advance(uint64_t(count));
  };
  LUXEL_TRY_STATUS(for_blocks(0, n, progress, solve));
  return for_blocks(0, n, progress, sum);
}

}  // namespace

ColourMatrix make_colour_factors(const FormFactors& factors, std::span<const Rgb> reflectance) {
  ColourMatrix out;
  const size_t n = factors.size();
  out.n = uint32_t(n);
  for (size_t c = 0; c < 3; ++c) {
    out.channel[c].resize(n * n);
    for (size_t i = 0; i < n; ++i)
      for (uint64_t k = factors.first[i]; k < factors.first[i + 1]; ++k) {
        const size_t j = factors.column[k];
        out.channel[c][i * n + j] = factors.factor[k] * reflectance[j][int(c)];
      }
  }
  return out;
}

Result<ColourMatrix> make_reflections(const FormFactors& factors, std::span<const Rgb> reflectance,
                                      std::span<const float> area_m2, int bounces,
                                      Progress& progress) {
  const size_t n = factors.size();
  LUXEL_CHECK(bounces != 0 && reflectance.size() == n && area_m2.size() == n);
  ColourMatrix out;
  out.n = uint32_t(n);
  progress.begin("reflections", 3 * n);
  const Matrix s = bounces < 0 ? symmetric_matrix(factors, area_m2) : Matrix();
  for (size_t c = 0; c < 3; ++c) {
    out.channel[c].resize(n * n);
    if (bounces < 0)
      LUXEL_TRY_STATUS(reflect_for_ever(s, reflectance, area_m2, int(c), out.channel[c], progress));
    else
      LUXEL_TRY_STATUS(reflect(factors, reflectance, int(c), bounces, out.channel[c], progress));
  }
  return out;
}

void multiply(const ColourMatrix& m, std::span<const Rgb> radiosity, std::span<Rgb> irradiance,
              DenseScratch& scratch) {
  const size_t n = m.n;
  LUXEL_CHECK(radiosity.size() == n && irradiance.size() == n && scratch.stride >= n);
  split_channels(radiosity, scratch);
  const auto rows = [&](size_t begin, size_t end) {
    const auto received = [&](size_t i, size_t c) {
      return inner_product(m.channel[c].data() + i * n, scratch.plane.data() + c * scratch.stride,
                           n);
    };
    for (size_t i = begin; i < end; ++i)
      irradiance[i] = {received(i, 0), received(i, 1), received(i, 2)};
  };
  parallel_for(n, kProductRows, std::ref(rows));
}

uint64_t bytes_of(const ColourMatrix& m) {
  uint64_t bytes = 0;
  for (const auto& channel : m.channel) bytes += 4 * channel.size();
  return bytes;
}

}  // namespace luxel::matrix
