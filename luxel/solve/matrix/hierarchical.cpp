#include "luxel/solve/matrix/hierarchical.h"

#include <algorithm>
#include <cmath>

#include "luxel/base/check.h"
#include "luxel/base/parallel.h"
#include "luxel/solve/matrix/cluster_functions.h"

namespace luxel::matrix {
namespace {

using Coupling = std::array<Values, kFunctions>;

/// Clusters whose centres are nearer than this part of their radii's sum touch or overlap: what
/// they exchange is not smooth, even where it seems so.
constexpr float kTouching = 0.75f;

/// What compression reads.
struct Source {
  const FormFactors& factors;
  std::span<const Cluster> clusters;
  std::span<const float> area_m2;
  ClusterFunctions functions;
  std::vector<double> cluster_m2;  ///< per cluster
  double leaf_m2 = 0;              ///< of a mean leaf
  HierarchicalParams params;
};

Source make_source(const FormFactors& factors, std::span<const Cluster> clusters,
                   std::span<const Vec3> position, std::span<const float> area_m2,
                   const HierarchicalParams& params) {
  Source s{factors, clusters, area_m2, make_functions(clusters, position, area_m2), {}, 0, params};
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

/// A block of the matrix: receivers x senders.
struct Block {
  uint32_t receiver = 0, sender = 0;
};

/// The two parts that a cluster is looked at as: its halves, or itself.
struct Parts {
  std::array<uint32_t, 2> cluster{};
  uint32_t count = 1;
  uint32_t middle = 0;  ///< first patch of the second one
};

Parts parts_of(const Source& s, uint32_t cluster, bool halves) {
  const Cluster& c = s.clusters[cluster];
  if (!halves) return {{cluster, cluster}, 1, c.end};
  return {{c.child, c.child + 1}, 2, s.clusters[c.child].end};
}

/// What a block couples, part by part.
struct Coupled {
  std::array<std::array<Coupling, 2>, 2> part{};
  std::array<std::array<uint32_t, 2>, 2> entries{};
  double noise = 0;  ///< expected square of noise in all coefficients
  uint64_t total() const {
    return uint64_t(entries[0][0]) + entries[0][1] + entries[1][0] + entries[1][1];
  }
};

/// Calls visit(i, j, S_ij) for all entries of a block.
template <class Visit>
void for_entries(const Source& s, const Block& block, const Visit& visit) {
  const Cluster& r = s.clusters[block.receiver];
  const Cluster& c = s.clusters[block.sender];
  for (uint32_t i = r.first; i < r.end; ++i) {
    const auto columns = s.factors.columns_of(i);
    const auto values = s.factors.factors_of(i);
    auto k = size_t(std::lower_bound(columns.begin(), columns.end(), c.first) - columns.begin());
    for (; k < columns.size() && columns[k] < c.end; ++k)
      visit(i, columns[k], values[k] * s.area_m2[i]);
  }
}

float square_sum(const Values& v) { return v[0] * v[0] + v[1] * v[1] + v[2] * v[2]; }

/// Variance of S_ij / sqrt(A_i A_j): both traced counts have that of a Poisson process, and the
/// mean of A_i F_ij and A_j F_ji a quarter of the sum.
double variance_of(const Source& s, uint32_t i, uint32_t j, float exchange) {
  const double a = double(s.area_m2[i]), b = double(s.area_m2[j]);
  return double(exchange) * (a + b) / (4 * a * b * s.params.rays_per_patch);
}

Coupled couple(const Source& s, const Block& block, const Parts& rows, const Parts& columns) {
  Coupled out;
  const std::vector<Values>& row_phi = s.functions.phi[s.clusters[rows.cluster[0]].depth];
  const std::vector<Values>& column_phi = s.functions.phi[s.clusters[columns.cluster[0]].depth];
  for_entries(s, block, [&](uint32_t i, uint32_t j, float exchange) {
    const size_t r = i >= rows.middle, c = j >= columns.middle;
    const Values& f = row_phi[i];
    const Values& g = column_phi[j];
    Coupling& sum = out.part[r][c];
    for (size_t a = 0; a < kFunctions; ++a)
      for (size_t b = 0; b < kFunctions; ++b) sum[a][b] += f[a] * exchange * g[b];
    ++out.entries[r][c];
    out.noise += variance_of(s, i, j, exchange) * double(square_sum(f) * s.area_m2[i]) *
                 double(square_sum(g) * s.area_m2[j]);
  });
  return out;
}

double square_sum(const Coupling& c) {
  double sum = 0;
  for (const Values& row : c)
    for (const float v : row) sum += double(v) * double(v);
  return sum;
}

/// What a task found, in the order of the recursion.
struct Found {
  struct Far {
    Block block;
    Coupling coupling;
  };
  std::vector<Far> far;
  std::vector<Block> near;
};

bool touching(const Source& s, const Block& block) {
  const Ball& a = s.functions.ball[block.receiver];
  const Ball& b = s.functions.ball[block.sender];
  return length(a.centre - b.centre) < kTouching * (a.radius_m + b.radius_m);
}

/// How much energy a block may lose. Light of 1 on all of a cluster has the energy of its area, so
/// what a block of large clusters loses counts for more.
double limit_of(const Source& s, const Block& block) {
  const double area = 0.5 * (s.cluster_m2[block.receiver] + s.cluster_m2[block.sender]);
  return double(s.params.block_error) * double(s.params.block_error) * s.leaf_m2 / area;
}

/// Whether the functions of two leaves see all but little of the entries between them, or all but
/// their noise.
bool leaves_are_smooth(const Source& s, const Block& block, const Coupling& coupling) {
  double energy = 0, noise = 0;
  for_entries(s, block, [&](uint32_t i, uint32_t j, float exchange) {
    const double area2 = double(s.area_m2[i]) * double(s.area_m2[j]);
    energy += double(exchange) * double(exchange) / area2;
    noise += variance_of(s, i, j, exchange);
  });
  return energy - square_sum(coupling) <= limit_of(s, block) + double(s.params.noise) * noise;
}

/// Two clusters whose radii are in a ratio above this are about as large. Halves of a surface have
/// 1 / sqrt 2 = 0.71 of its radius: clusters one level apart still are, those two levels apart
/// (0.5) are not.
constexpr float kAboutAsLarge = 0.6f;

/// The larger of two clusters is halved, both when they are about as large.
struct Halving {
  bool rows = false, columns = false;
};
Halving halving_of(const Source& s, const Block& block) {
  const Cluster& r = s.clusters[block.receiver];
  const Cluster& c = s.clusters[block.sender];
  const float row_m = s.functions.ball[block.receiver].radius_m,
              column_m = s.functions.ball[block.sender].radius_m;
  const bool rows = !r.is_leaf() && (c.is_leaf() || row_m > kAboutAsLarge * column_m);
  const bool columns = !c.is_leaf() && (r.is_leaf() || column_m > kAboutAsLarge * row_m);
  return {rows, columns};
}

/// The smaller half has at least this share of a cluster's area. Where trees split off less, the
/// larger half is nearly the cluster, and its functions see no more of a block, however uneven that
/// is.
constexpr double kLeastHalf = 1.0 / 16;

bool has_two_halves(const Source& s, const Parts& parts, uint32_t cluster) {
  if (parts.count == 1) return true;
  const auto [a, b] = parts.cluster;
  return std::min(s.cluster_m2[a], s.cluster_m2[b]) >= kLeastHalf * s.cluster_m2[cluster];
}

/// Whether a block passes through its own functions: what its parts' functions see more is little,
/// or noise.
bool is_smooth(const Source& s, const Block& block, const Coupling& coupling,
               const Coupled& parts) {
  if (touching(s, block)) return false;
  double energy = 0;
  for (const auto& row : parts.part)
    for (const Coupling& part : row) energy += square_sum(part);
  return energy - square_sum(coupling) <= limit_of(s, block) + double(s.params.noise) * parts.noise;
}

void visit(const Source& s, const Block& block, const Coupling& coupling, Found& out) {
  const Halving halving = halving_of(s, block);
  if (!halving.rows && !halving.columns) {
    if (!touching(s, block) && leaves_are_smooth(s, block, coupling))
      out.far.push_back({block, coupling});
    else
      out.near.push_back(block);
    return;
  }
  const Parts rows = parts_of(s, block.receiver, halving.rows);
  const Parts columns = parts_of(s, block.sender, halving.columns);
  const Coupled coupled = couple(s, block, rows, columns);
  const bool telling =
      has_two_halves(s, rows, block.receiver) && has_two_halves(s, columns, block.sender);
  if (telling && is_smooth(s, block, coupling, coupled)) {
    out.far.push_back({block, coupling});
    return;
  }
  for (uint32_t r = 0; r < rows.count; ++r)
    for (uint32_t c = 0; c < columns.count; ++c)
      if (coupled.entries[r][c] > 0)
        visit(s, {rows.cluster[r], columns.cluster[c]}, coupled.part[r][c], out);
}

/// Receivers at one depth, or leaves above it: tasks that do not depend on each other.
std::vector<uint32_t> task_receivers(std::span<const Cluster> clusters) {
  constexpr uint32_t kTaskDepth = 6;
  std::vector<uint32_t> out;
  for (uint32_t c = 0; c < clusters.size(); ++c)
    if (clusters[c].depth == kTaskDepth ||
        (clusters[c].depth < kTaskDepth && clusters[c].is_leaf()))
      out.push_back(c);
  return out;
}

/// Walks from (receiver, all) down: blocks above the receiver's depth are never smooth enough.
void visit_receiver(const Source& s, uint32_t receiver, uint32_t sender, Found& out) {
  const Cluster& r = s.clusters[receiver];
  const Cluster& c = s.clusters[sender];
  if (c.depth < r.depth && !c.is_leaf()) {
    visit_receiver(s, receiver, c.child, out);
    visit_receiver(s, receiver, c.child + 1, out);
    return;
  }
  const Block block{receiver, sender};
  const Coupled whole = couple(s, block, parts_of(s, receiver, false), parts_of(s, sender, false));
  if (whole.entries[0][0] > 0) visit(s, block, whole.part[0][0], out);
}

/// Entries of a leaf pair in 8 bits. What rounding takes from one sender's the next gets, so that
/// the sum over a row is kept.
void append_near(const Source& s, const Block& block, Hierarchical& out) {
  const Cluster& r = s.clusters[block.receiver];
  const Cluster& c = s.clusters[block.sender];
  constexpr uint32_t rows = kLeafSize;
  std::vector<float> value(size_t(rows) * c.size(), 0.0f);
  float largest = 0;
  for_entries(s, block, [&](uint32_t i, uint32_t j, float exchange) {
    float& v = value[size_t(j - c.first) * rows + (i - r.first)];
    v = exchange / s.area_m2[i];
    largest = std::max(largest, v);
  });
  const float scale = largest / 255;
  out.near.push_back({block.sender, uint32_t(out.entries.size()), scale});
  std::vector<float> carried(rows, 0.0f);
  for (uint32_t j = 0; j < c.size(); ++j)
    for (uint32_t i = 0; i < rows; ++i) {
      const float wanted = value[size_t(j) * rows + i] / std::max(scale, 1e-30f) + carried[i];
      const float kept = std::clamp(std::round(wanted), 0.0f, 255.0f);
      carried[i] = wanted - kept;
      out.entries.push_back(uint8_t(kept));
    }
}

/// In 16 bits each of the largest.
Hierarchical::Far quantised(const Found::Far& far) {
  float largest = 0;
  for (const Values& row : far.coupling)
    for (const float v : row) largest = std::max(largest, std::abs(v));
  Hierarchical::Far out{{}, largest / 32767, far.block.sender};
  if (largest > 0)
    for (size_t a = 0; a < kFunctions; ++a)
      for (size_t b = 0; b < kFunctions; ++b)
        out.coefficient[kLanes * b + a] =
            int16_t(std::lround(far.coupling[a][b] / largest * 32767));
  return out;
}

/// Blocks of all tasks, receiver by receiver.
void append_blocks(const Source& s, std::vector<Found>& found, Hierarchical& out) {
  std::vector<Found::Far> far;
  std::vector<Block> near;
  for (Found& f : found) {
    far.insert(far.end(), f.far.begin(), f.far.end());
    near.insert(near.end(), f.near.begin(), f.near.end());
    f = {};
  }
  const auto by_receiver = [](const Block& a, const Block& b) { return a.receiver < b.receiver; };
  std::stable_sort(far.begin(), far.end(),
                   [&](const auto& a, const auto& b) { return by_receiver(a.block, b.block); });
  std::stable_sort(near.begin(), near.end(), by_receiver);
  size_t f = 0, n = 0;
  for (uint32_t c = 0; c < out.clusters.size(); ++c) {
    out.first_far.push_back(uint32_t(out.far.size()));
    out.first_near.push_back(uint32_t(out.near.size()));
    for (; f < far.size() && far[f].block.receiver == c; ++f) out.far.push_back(quantised(far[f]));
    for (; n < near.size() && near[n].receiver == c; ++n) append_near(s, near[n], out);
  }
  out.first_far.push_back(uint32_t(out.far.size()));
  out.first_near.push_back(uint32_t(out.near.size()));
}

Hierarchical assemble(const Source& s, std::vector<Found>& found) {
  Hierarchical out;
  out.clusters.assign(s.clusters.begin(), s.clusters.end());
  out.area_m2.assign(s.area_m2.begin(), s.area_m2.end());
  out.up = make_up(s.functions, s.clusters, s.area_m2);
  out.phi.resize(s.area_m2.size());
  for (const Cluster& c : s.clusters)
    if (c.is_leaf())
      for (uint32_t i = c.first; i < c.end; ++i) out.phi[i] = s.functions.phi[c.depth][i];
  append_blocks(s, found, out);
  return out;
}

}  // namespace

Result<Hierarchical> compress(const FormFactors& factors, const ClusterTree& tree,
                              std::span<const Vec3> position, std::span<const float> area_m2,
                              const HierarchicalParams& params, Progress& progress) {
  LUXEL_CHECK(position.size() == factors.size() && area_m2.size() == factors.size());
  for (const Cluster& c : tree.clusters) LUXEL_CHECK(!c.is_leaf() || c.size() <= kLeafSize);
  const Source source = make_source(factors, tree.clusters, position, area_m2, params);
  const std::vector<uint32_t> receivers = task_receivers(tree.clusters);
  std::vector<Found> found(receivers.size());
  progress.begin("compress", receivers.size());
  parallel_for(receivers.size(), 1, [&](size_t begin, size_t end) {
    for (size_t k = begin; k < end && !progress.cancelled(); ++k) {
      visit_receiver(source, receivers[k], 0, found[k]);
      progress.advance(1);
    }
  });
  LUXEL_TRY_STATUS(stopped(progress));
  return assemble(source, found);
}

uint64_t bytes_of(const Hierarchical& m) {
  const auto bytes = [](const auto& v) { return uint64_t(v.size() * sizeof(v[0])); };
  return bytes(m.clusters) + bytes(m.up) + bytes(m.phi) + bytes(m.area_m2) + bytes(m.first_far) +
         bytes(m.far) + bytes(m.first_near) + bytes(m.near) + bytes(m.entries);
}

}  // namespace luxel::matrix
