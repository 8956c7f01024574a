#include "luxel/solve/matrix/block_coupling.h"

#include <algorithm>

#include "luxel/base/check.h"
#include "luxel/base/parallel.h"
#include "luxel/base/vectorize.h"

namespace luxel::matrix {
namespace {

float squared_length(const Values& v) { return v[0] * v[0] + v[1] * v[1] + v[2] * v[2]; }

std::vector<std::vector<SenderValues>> sender_values(const ClusterFunctions& functions,
                                                     std::span<const float> area_m2) {
  std::vector<std::vector<SenderValues>> out(functions.phi.size());
  parallel_for(out.size(), 1, [&](size_t begin, size_t end) {
    for (size_t depth = begin; depth < end; ++depth)
      for (size_t i = 0; i < area_m2.size(); ++i) {
        const Values& phi = functions.phi[depth][i];
        const float square = squared_length(phi);
        out[depth].push_back({phi[0], phi[1], phi[2], square, square * area_m2[i]});
      }
  });
  return out;
}

/// The entries [begin, end) of a row: sum_k factor_k sender_(column k).
[[gnu::always_inline]] inline void add_entries(const uint32_t* column, const float* factor,
                                               uint32_t begin, uint32_t end,
                                               const SenderValues* sender, float* out) {
  Float8 sum = {};
  for (uint32_t k = begin; k < end; ++k) {
    Float8 lanes;
    load8(sender[column[k]].data(), lanes);
    sum += factor[k] * lanes;
  }
  store8(sum, out);
}

/// A row of a block. Both traced counts of S_ij have the variance of a Poisson process, and the
/// mean of A_i F_ij and A_j F_ji a quarter of their sum: S_ij (A_i + A_j) / 4 rays. A coefficient
/// has (phi_a(i) phi_b(j))^2 times that.
[[gnu::always_inline]] inline void add_row(const float* sum, const Values& phi, float area_m2,
                                           Coupling& coupling, double& noise) {
  for (size_t a = 0; a < kFunctions; ++a)
    for (size_t b = 0; b < kFunctions; ++b) coupling[a][b] += phi[a] * area_m2 * sum[b];
  noise += double(squared_length(phi) * area_m2) * double(area_m2 * sum[3] + sum[4]);
}

LUXEL_VECTOR_CLONES
void couple_rows(const CouplingSource& s, const Block& block, const Parts& rows,
                 const Parts& columns, std::span<RowRange> ranges, Coupled& out) {
  const Cluster& r = s.clusters[block.receiver];
  const Values* row_phi = s.functions.phi[s.clusters[rows.cluster[0]].depth].data();
  const SenderValues* sender = s.sender[s.clusters[columns.cluster[0]].depth].data();
  for (uint32_t i = r.first; i < r.end; ++i) {
    RowRange& range = ranges[i - r.first];
    const uint32_t* column = s.factors.column.data() + s.factors.first[i];
    const float* factor = s.factors.factor.data() + s.factors.first[i];
    const size_t part = i >= rows.middle;
    range.middle = range.end;
    if (columns.count == 2)
      range.middle = uint32_t(
          std::lower_bound(column + range.begin, column + range.end, columns.middle) - column);
    const uint32_t bounds[] = {range.begin, range.middle, range.end};
    for (size_t c = 0; c < columns.count; ++c) {
      if (bounds[c] == bounds[c + 1]) continue;
      float sum[8];
      add_entries(column, factor, bounds[c], bounds[c + 1], sender, sum);
      add_row(sum, row_phi[i], s.area_m2[i], out.part[part][c], out.noise);
      out.entries[part][c] += bounds[c + 1] - bounds[c];
    }
  }
}

/// Calls visit(i, j, F_ij) for all entries of a block.
template <class Visit>
void for_entries(const CouplingSource& s, const Block& block, std::span<const RowRange> ranges,
                 const Visit& visit) {
  const Cluster& r = s.clusters[block.receiver];
  for (uint32_t i = r.first; i < r.end; ++i)
    for (uint32_t k = ranges[i - r.first].begin; k < ranges[i - r.first].end; ++k)
      visit(i, s.factors.columns_of(i)[k], s.factors.factors_of(i)[k]);
}

}  // namespace

CouplingSource make_coupling_source(const FormFactors& factors, std::span<const Cluster> clusters,
                                    std::span<const Vec3> position, std::span<const float> area_m2,
                                    int rays_per_patch) {
  CouplingSource s{factors,
                   clusters,
                   area_m2,
                   float(rays_per_patch),
                   make_functions(clusters, position, area_m2),
                   {},
                   {},
                   0};
  s.sender = sender_values(s.functions, area_m2);
  uint32_t leaves = 0;
  for (const Cluster& c : clusters) {
    leaves += c.is_leaf();
    double area = 0;
    for (uint32_t i = c.first; i < c.end; ++i) area += double(area_m2[i]);
    s.cluster_m2.push_back(area);
  }
  s.leaf_m2 = s.cluster_m2.front() / leaves;
  return s;
}

void find_ranges(const CouplingSource& s, const Block& block, std::span<RowRange> ranges) {
  const Cluster& r = s.clusters[block.receiver];
  const Cluster& c = s.clusters[block.sender];
  for (uint32_t i = r.first; i < r.end; ++i) {
    const auto columns = s.factors.columns_of(i);
    const auto begin = std::lower_bound(columns.begin(), columns.end(), c.first);
    const auto end = std::lower_bound(begin, columns.end(), c.end);
    ranges[i - r.first] = {uint32_t(begin - columns.begin()), uint32_t(end - columns.begin()),
                           uint32_t(end - columns.begin())};
  }
}

Parts parts_of(const CouplingSource& s, uint32_t cluster, bool halves) {
  const Cluster& c = s.clusters[cluster];
  if (!halves) return {{cluster, cluster}, 1, c.end};
  return {{c.child, c.child + 1}, 2, s.clusters[c.child].end};
}

Coupled couple(const CouplingSource& s, const Block& block, const Parts& rows, const Parts& columns,
               std::span<RowRange> ranges) {
  Coupled out;
  couple_rows(s, block, rows, columns, ranges, out);
  out.noise /= 4 * double(s.rays_per_patch);
  return out;
}

double square_sum(const Coupling& c) {
  double sum = 0;
  for (const Values& row : c)
    for (const float v : row) sum += double(v) * double(v);
  return sum;
}

Energy energy_of(const CouplingSource& s, const Block& block, std::span<const RowRange> ranges) {
  Energy out;
  for_entries(s, block, ranges, [&](uint32_t i, uint32_t j, float factor) {
    const double a = double(s.area_m2[i]), b = double(s.area_m2[j]);
    out.entries += double(factor) * double(factor) * a / b;
    out.noise += double(factor) * (a + b) / (4 * b * double(s.rays_per_patch));
  });
  return out;
}

void near_entries(const CouplingSource& s, const Block& block, std::span<const RowRange> ranges,
                  std::span<float> value) {
  const uint32_t row = s.clusters[block.receiver].first, column = s.clusters[block.sender].first;
  std::fill(value.begin(), value.end(), 0.0f);
  for_entries(s, block, ranges, [&](uint32_t i, uint32_t j, float factor) {
    value[size_t(j - column) * kLeafSize + (i - row)] = factor;
  });
}

}  // namespace luxel::matrix
