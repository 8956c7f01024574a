#include <Eigen/Sparse>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "luxel/base/check.h"
#include "luxel/base/parallel.h"
#include "luxel/post/seams.h"

namespace luxel::post {
namespace {

using Columns = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;  ///< R, G, B
using Rows = Eigen::SparseMatrix<double, Eigen::RowMajor>;

/// A bilinear lookup inside a chart, as transport::irradiance_at does it: only texels that carry a
/// sample, weights renormalised; hidden ones are left out.
struct Lookup {
  std::array<uint32_t, 4> texel{};
  std::array<double, 4> weight{};
  int count = 0;
};

Lookup lookup(const atlas::TexelMap& map, std::span<const uint8_t> hidden, Vec2 at) {
  const int side = map.resolution;
  const int x0 = int(std::floor(at.x - 0.5f)), y0 = int(std::floor(at.y - 0.5f));
  const double fx = double(at.x) - 0.5 - x0, fy = double(at.y) - 0.5 - y0;
  Lookup out;
  double sum = 0;
  for (int j = 0; j < 2; ++j)
    for (int i = 0; i < 2; ++i) {
      const int x = x0 + i, y = y0 + j;
      if (x < 0 || y < 0 || x >= side || y >= side) continue;
      const uint32_t texel = map.texel_at[size_t(y) * size_t(side) + size_t(x)];
      const double w = (i ? fx : 1 - fx) * (j ? fy : 1 - fy);
      if (texel == atlas::kNone || w <= 0 || (!hidden.empty() && hidden[texel])) continue;
      out.texel[size_t(out.count)] = texel;
      out.weight[size_t(out.count++)] = w;
      sum += w;
    }
  for (double& w : out.weight) w /= out.count > 0 ? sum : 1;
  return out;
}

/// A point on a seam, as both sides see it.
struct SeamPoint {
  Lookup a, b;
  double half_texels = 0;  ///< the length of seam that it stands for
};

/// Both look-ups read texels of one region.
bool is_in_one_region(const SeamPoint& point, std::span<const uint32_t> region) {
  if (region.empty()) return true;
  for (const Lookup* side : {&point.a, &point.b})
    for (int i = 0; i < side->count; ++i)
      if (region[side->texel[size_t(i)]] != region[point.a.texel[0]]) return false;
  return true;
}

/// Points where both sides have texels, of one region.
std::vector<SeamPoint> seam_points(const atlas::TexelMap& map, std::span<const Seam> seams,
                                   const SeamTexels& texels) {
  const auto& [hidden, region] = texels;
  LUXEL_CHECK(hidden.empty() || hidden.size() == map.texels.size());
  LUXEL_CHECK(region.empty() || region.size() == map.texels.size());
  std::vector<SeamPoint> points;
  for (const Seam& seam : seams) {
    const float longer = std::max(length(seam.a1 - seam.a0), length(seam.b1 - seam.b0));
    const int count = std::max(2, int(std::ceil(2 * longer)));
    for (int i = 0; i < count; ++i) {
      const float t = (float(i) + 0.5f) / float(count);
      SeamPoint point{lookup(map, hidden, seam.a0 * (1 - t) + seam.a1 * t),
                      lookup(map, hidden, seam.b0 * (1 - t) + seam.b1 * t),
                      2 * double(longer) / double(count)};
      if (point.a.count > 0 && point.b.count > 0 && is_in_one_region(point, region))
        points.push_back(point);
    }
  }
  return points;
}

std::array<double, 3> value(const Lookup& side, std::span<const Rgb> values) {
  std::array<double, 3> sum{};
  for (int i = 0; i < side.count; ++i)
    for (int c = 0; c < 3; ++c)
      sum[size_t(c)] += side.weight[size_t(i)] * double(values[side.texel[size_t(i)]][c]);
  return sum;
}

/// The mean of both sides and all channels.
double mean_value(const SeamPoint& point, std::span<const Rgb> values) {
  const auto a = value(point.a, values), b = value(point.b, values);
  return (a[0] + a[1] + a[2] + b[0] + b[1] + b[2]) / 6;
}

bool is_black(const Lookup& side, std::span<const Rgb> values) {
  return value(side, values) == std::array<double, 3>{};
}

/// minimise |D d + D x|^2 + |K d|^2 over the change d of the unknown texels.
struct System {
  std::vector<uint32_t> texel;  ///< of each unknown
  Rows difference;              ///< D: side a minus side b, a row per point
  Rows transposed;              ///< D^T: rows again, so that both products run in parallel
  Eigen::VectorXd keep2;        ///< the squares of the diagonal K
};

/// Numbers the texels under the lookups in the order of first use.
std::vector<uint32_t> unknown_numbers(const std::vector<SeamPoint>& points, size_t texel_count,
                                      std::vector<uint32_t>& texel) {
  std::vector<uint32_t> number(texel_count, atlas::kNone);
  for (const SeamPoint& point : points)
    for (const Lookup* side : {&point.a, &point.b})
      for (int i = 0; i < side->count; ++i) {
        uint32_t& n = number[side->texel[size_t(i)]];
        if (n != atlas::kNone) continue;
        n = uint32_t(texel.size());
        texel.push_back(side->texel[size_t(i)]);
      }
  return number;
}

/// Row weights and keep weights are those of the header's formula.
System build_system(const std::vector<SeamPoint>& points, std::span<const Rgb> values,
                    double keep_weight) {
  System system;
  const std::vector<uint32_t> number = unknown_numbers(points, values.size(), system.texel);
  const Eigen::Index unknowns = Eigen::Index(system.texel.size());

  std::vector<double> around(points.size());  // m_p
  double mean = 0;
  for (size_t p = 0; p < points.size(); ++p) mean += around[p] = mean_value(points[p], values);
  mean /= double(points.size());
  for (double& m : around) m += 1e-3 * mean;

  Eigen::VectorXd weighted = Eigen::VectorXd::Zero(unknowns), weight = weighted;
  std::vector<Eigen::Triplet<double, int>> entries;
  entries.reserve(8 * points.size());
  for (size_t p = 0; p < points.size(); ++p) {
    const double row_weight = std::sqrt(points[p].half_texels) / around[p];
    for (const Lookup* side : {&points[p].a, &points[p].b})
      for (int i = 0; i < side->count; ++i) {
        const uint32_t n = number[side->texel[size_t(i)]];
        const double w = side->weight[size_t(i)];
        entries.emplace_back(int(p), int(n), (side == &points[p].a ? w : -w) * row_weight);
        weighted[n] += w * around[p];
        weight[n] += w;
      }
  }
  system.difference.resize(Eigen::Index(points.size()), unknowns);
  system.difference.setFromTriplets(entries.begin(), entries.end());
  system.transposed = system.difference.transpose();
  const Eigen::ArrayXd around_texel = weighted.array() / weight.array();  // m_t
  system.keep2 = (keep_weight / around_texel).square().matrix();
  return system;
}

/// rows * x. Every row is one sum in fixed order: the same bits for any number of threads.
void multiply(const Rows& rows, const Columns& x, Columns& out) {
  out.resize(rows.rows(), 3);
  parallel_for(size_t(rows.rows()), 4096, [&](size_t begin, size_t end) {
    for (Eigen::Index row = Eigen::Index(begin); row < Eigen::Index(end); ++row) {
      Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
      for (Rows::InnerIterator entry(rows, row); entry; ++entry)
        sum += entry.value() * x.row(entry.col());
      out.row(row) = sum;
    }
  });
}

Eigen::RowVector3d column_dots(const Columns& a, const Columns& b) {
  return a.cwiseProduct(b).colwise().sum();
}

/// Quotients of the conjugate gradient; a channel that is done stands still.
Eigen::RowVector3d quotient(const Eigen::RowVector3d& a, const Eigen::RowVector3d& b) {
  Eigen::RowVector3d q;
  for (int c = 0; c < 3; ++c) q[c] = b[c] > 0 ? a[c] / b[c] : 0.0;
  return q;
}

/// Conjugate gradients for (D^T D + K^2) d = -D^T D x, Jacobi-preconditioned, channels side by
/// side.
Result<Columns> solve(const System& system, const Columns& x, int max_iterations,
                      const Progress& progress) {
  const Eigen::VectorXd diagonal =
      Eigen::VectorXd(system.transposed.cwiseAbs2() *
                      Eigen::VectorXd::Ones(system.difference.rows())) +
      system.keep2;
  const Eigen::VectorXd inverse = diagonal.cwiseInverse();
  Columns on_points, residual, image;
  multiply(system.difference, x, on_points);
  multiply(system.transposed, on_points, residual);
  residual *= -1;
  Columns change = Columns::Zero(x.rows(), 3);
  Columns z = inverse.asDiagonal() * residual, direction = z;
  Eigen::RowVector3d rz = column_dots(residual, z);
  const Eigen::RowVector3d goal = rz * 1e-10;  // squares: five digits
  for (int i = 0; i < max_iterations && (rz.array() > goal.array()).any(); ++i) {
    LUXEL_TRY_STATUS(stopped(progress));
    multiply(system.difference, direction, on_points);
    multiply(system.transposed, on_points, image);
    image += system.keep2.asDiagonal() * direction;
    const Eigen::RowVector3d step = quotient(rz, column_dots(direction, image));
    change += direction * step.asDiagonal();
    residual -= image * step.asDiagonal();
    z = inverse.asDiagonal() * residual;
    const Eigen::RowVector3d next = column_dots(residual, z);
    direction = z + direction * quotient(next, rz).asDiagonal();
    rz = next;
  }
  return change;
}

/// Nothing, where there is nothing to agree on. Where a side is black, relative errors mean
/// nothing, and light does not go on over the seam.
std::optional<System> system_of(const atlas::TexelMap& map, std::span<const Seam> seams,
                                const SeamParams& params, std::span<const Rgb> values) {
  LUXEL_CHECK(values.size() == map.texels.size());
  LUXEL_CHECK(params.keep_weight > 0);
  for (const Rgb& v : values) LUXEL_CHECK(is_finite(v) && min_component(v) >= 0);
  std::vector<SeamPoint> points = seam_points(map, seams, params.texels);
  std::erase_if(points,
                [&](const SeamPoint& p) { return is_black(p.a, values) || is_black(p.b, values); });
  if (points.empty()) return std::nullopt;
  return build_system(points, values, double(params.keep_weight));
}

/// Adds the change that solves the system for these values.
Status move_values(const System& system, const SeamParams& params, std::span<Rgb> values,
                   const Progress& progress) {
  Columns x(Eigen::Index(system.texel.size()), 3);
  for (Eigen::Index n = 0; n < x.rows(); ++n) {
    const Rgb v = values[system.texel[size_t(n)]];
    x.row(n) << double(v.x), double(v.y), double(v.z);
  }
  LUXEL_TRY(const Columns change, solve(system, x, params.max_iterations, progress));
  for (Eigen::Index n = 0; n < x.rows(); ++n) {
    const auto moved = [&](int c) { return float(std::max(0.0, x(n, c) + change(n, c))); };
    values[system.texel[size_t(n)]] = {moved(0), moved(1), moved(2)};
  }
  return {};
}

}  // namespace

Status stitch_seams(const atlas::TexelMap& map, std::span<const Seam> seams,
                    const SeamParams& params, std::span<Rgb> values, Progress& progress) {
  const std::optional<System> system = system_of(map, seams, params, values);
  return system ? move_values(*system, params, values, progress) : Status{};
}

Status stitch_layers(const atlas::TexelMap& map, std::span<const Seam> seams,
                     const SeamParams& params, std::span<const Rgb> whole,
                     std::span<std::vector<Rgb>> layers, Progress& progress) {
  const std::optional<System> system = system_of(map, seams, params, whole);
  if (!system) return {};
  for (std::vector<Rgb>& layer : layers) {
    LUXEL_CHECK(layer.size() == whole.size());
    LUXEL_TRY_STATUS(move_values(*system, params, layer, progress));
  }
  return {};
}

namespace {

struct Differences {
  double squares = 0;            ///< sum over points and channels
  double mean = 0;               ///< value
  std::vector<double> relative;  ///< per point, as SeamResidual says
};

Differences differences_at(const std::vector<SeamPoint>& points, std::span<const Rgb> values) {
  Differences d;
  for (const SeamPoint& point : points) d.mean += mean_value(point, values) / double(points.size());
  for (const SeamPoint& point : points) {
    const auto a = value(point.a, values), b = value(point.b, values);
    double largest = 0;
    for (size_t c = 0; c < 3; ++c) {
      d.squares += (a[c] - b[c]) * (a[c] - b[c]);
      largest = std::max(largest, std::abs(a[c] - b[c]));
    }
    const double around = mean_value(point, values) + 1e-3 * d.mean;
    d.relative.push_back(around > 0 ? largest / around : 0);
  }
  return d;
}

}  // namespace

SeamResidual seam_residual(const atlas::TexelMap& map, std::span<const Seam> seams,
                           std::span<const Rgb> values, const SeamTexels& texels) {
  LUXEL_CHECK(values.size() == map.texels.size());
  const std::vector<SeamPoint> points = seam_points(map, seams, texels);
  Differences d = differences_at(points, values);
  if (points.empty() || d.mean <= 0) return {};
  const auto p95 = d.relative.begin() + std::ptrdiff_t((d.relative.size() - 1) * 95 / 100);
  std::nth_element(d.relative.begin(), p95, d.relative.end());
  return {std::sqrt(d.squares / (3 * double(points.size()))) / d.mean, *p95,
          *std::max_element(p95, d.relative.end())};
}

std::vector<float> seam_errors(const atlas::TexelMap& map, std::span<const Seam> seams,
                               std::span<const Rgb> values, const SeamTexels& texels) {
  LUXEL_CHECK(values.size() == map.texels.size());
  const std::vector<SeamPoint> points = seam_points(map, seams, texels);
  const Differences d = differences_at(points, values);
  std::vector<float> error(map.texels.size());
  for (size_t p = 0; p < points.size(); ++p)
    for (const Lookup* side : {&points[p].a, &points[p].b})
      for (int i = 0; i < side->count; ++i) {
        float& e = error[side->texel[size_t(i)]];
        e = std::max(e, float(d.relative[p]));
      }
  return error;
}

}  // namespace luxel::post
