#include "solve/matrix/hierarchical.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "base/parallel.h"

namespace luxel::matrix {
namespace {

using Values = std::array<float, kFunctions>;
using Coupling = std::array<Values, kFunctions>;

/// A direction in which patches spread by less than this part of the widest is none.
constexpr double kThin = 1e-3;
/// Clusters whose centres are nearer than this part of their radii's sum touch or overlap: what
/// they exchange is not smooth, even where it seems so.
constexpr float kTouching = 0.75f;

/// Where a cluster lies.
struct Ball {
  Vec3 centre;
  float radius_m = 0;
};

Ball ball_of(const Cluster& cluster, std::span<const Vec3> position,
             std::span<const float> area_m2) {
  Ball ball;
  float area = 0;
  for (uint32_t i = cluster.first; i < cluster.end; ++i)
    ball.centre += position[i] * area_m2[i], area += area_m2[i];
  ball.centre = ball.centre / std::max(area, 1e-30f);
  for (uint32_t i = cluster.first; i < cluster.end; ++i)
    ball.radius_m = std::max(ball.radius_m, length(position[i] - ball.centre));
  return ball;
}

using Powers = std::array<double, 4>;  ///< of 1, x, y, z
using Gram = std::array<Powers, 4>;    ///< their inner products over a cluster

/// Combinations of the powers that are orthonormal: 1, then the widest directions. Zero where there
/// are none.
std::array<Powers, kFunctions> orthonormal(const Gram& gram) {
  const auto inner = [&](const Powers& f, const Powers& g) {
    double sum = 0;
    for (size_t a = 0; a < 4; ++a)
      for (size_t b = 0; b < 4; ++b) sum += f[a] * gram[a][b] * g[b];
    return sum;
  };
  Gram rest{};  // each power less its part in the functions there are
  for (size_t f = 0; f < 4; ++f) rest[f][f] = 1;
  std::array<Powers, kFunctions> out{};
  double widest = 0;
  for (size_t k = 0; k < kFunctions; ++k) {
    size_t next = k == 0 ? 0 : 1;
    for (size_t f = 2; f < 4 && k > 0; ++f)
      if (inner(rest[f], rest[f]) > inner(rest[next], rest[next])) next = f;
    const double norm2 = inner(rest[next], rest[next]);
    if (k == 1) widest = norm2;
    if (!(norm2 > 0) || (k > 0 && norm2 <= std::max(kThin * widest, 1e-6 * gram[0][0]))) break;
    for (size_t b = 0; b < 4; ++b) out[k][b] = rest[next][b] / std::sqrt(norm2);
    for (Powers& f : rest) {
      const double part = inner(f, out[k]);
      for (size_t b = 0; b < 4; ++b) f[b] -= part * out[k][b];
    }
  }
  return out;
}

/// What compression reads.
struct Source {
  const FormFactors& factors;
  std::span<const Cluster> clusters;
  std::span<const float> area_m2;
  std::vector<Ball> ball;          ///< per cluster
  std::vector<double> cluster_m2;  ///< per cluster
  double leaf_m2 = 0;              ///< of a mean leaf
  /// Per depth and patch, the functions of the patch's cluster there.
  std::vector<std::vector<Values>> phi;
  HierarchicalParams params;
};

/// The powers of a cluster's patches as its halves' functions see them (a leaf's: themselves), so
/// that its own functions are combinations of those.
std::vector<Powers> powers_of(const Source& s, const Cluster& cluster, const Ball& ball,
                              std::span<const Vec3> position) {
  std::vector<Powers> power(cluster.size());
  for (uint32_t i = cluster.first; i < cluster.end; ++i) {
    const Vec3 d = (position[i] - ball.centre) / std::max(ball.radius_m, 1e-30f);
    power[i - cluster.first] = {1, double(d.x), double(d.y), double(d.z)};
  }
  for (uint32_t c = cluster.child; c != 0 && c < cluster.child + 2; ++c) {
    const Cluster& half = s.clusters[c];
    const std::vector<Values>& phi = s.phi[half.depth];
    std::array<Powers, kFunctions> part{};  // of the powers in the half's functions
    for (uint32_t i = half.first; i < half.end; ++i)
      for (size_t a = 0; a < kFunctions; ++a)
        for (size_t f = 0; f < 4; ++f)
          part[a][f] += double(s.area_m2[i]) * double(phi[i][a]) * power[i - cluster.first][f];
    for (uint32_t i = half.first; i < half.end; ++i)
      for (size_t f = 0; f < 4; ++f) {
        double sum = 0;
        for (size_t a = 0; a < kFunctions; ++a) sum += double(phi[i][a]) * part[a][f];
        power[i - cluster.first][f] = sum;
      }
  }
  return power;
}

void add_functions(const Cluster& cluster, std::span<const Powers> power, Source& s) {
  Gram gram{};
  for (uint32_t i = 0; i < cluster.size(); ++i)
    for (size_t a = 0; a < 4; ++a)
      for (size_t b = 0; b < 4; ++b)
        gram[a][b] += double(s.area_m2[cluster.first + i]) * power[i][a] * power[i][b];
  const std::array<Powers, kFunctions> function = orthonormal(gram);
  for (uint32_t i = 0; i < cluster.size(); ++i)
    for (size_t a = 0; a < kFunctions; ++a) {
      double sum = 0;
      for (size_t f = 0; f < 4; ++f) sum += function[a][f] * power[i][f];
      s.phi[cluster.depth][cluster.first + i][a] = float(sum);
    }
}

Source make_source(const FormFactors& factors, std::span<const Cluster> clusters,
                   std::span<const Vec3> position, std::span<const float> area_m2,
                   const HierarchicalParams& params) {
  Source s{factors, clusters, area_m2, {}, {}, 0, {}, params};
  uint32_t depth = 0, leaves = 0;
  for (const Cluster& c : clusters) {
    depth = std::max(depth, c.depth), leaves += c.is_leaf();
    double area = 0;
    for (uint32_t i = c.first; i < c.end; ++i) area += double(area_m2[i]);
    s.cluster_m2.push_back(area);
    s.ball.push_back(ball_of(c, position, area_m2));
  }
  s.leaf_m2 = s.cluster_m2.front() / leaves;
  s.phi.assign(depth + 1, std::vector<Values>(position.size()));
  for (size_t c = clusters.size(); c-- > 0;)  // halves come after what they are halves of
    add_functions(clusters[c], powers_of(s, clusters[c], s.ball[c], position), s);
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
  const auto& row_phi = s.phi[s.clusters[rows.cluster[0]].depth];
  const auto& column_phi = s.phi[s.clusters[columns.cluster[0]].depth];
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
  const Ball& a = s.ball[block.receiver];
  const Ball& b = s.ball[block.sender];
  return length(a.centre - b.centre) < kTouching * (a.radius_m + b.radius_m);
}

/// How much energy a block may lose. Light of 1 on all of a cluster has the energy of its area, so
/// what a block of large clusters loses counts for more.
double limit_of(const Source& s, const Block& block) {
  const double area = 0.5 * (s.cluster_m2[block.receiver] + s.cluster_m2[block.sender]);
  return double(s.params.block_error) * double(s.params.block_error) * s.leaf_m2 / area;
}

/// Of a leaf pair: how much of the entries no functions see, against their noise.
bool leaves_are_smooth(const Source& s, const Block& block, const Coupling& coupling) {
  double energy = 0, noise = 0;
  for_entries(s, block, [&](uint32_t i, uint32_t j, float exchange) {
    const double area2 = double(s.area_m2[i]) * double(s.area_m2[j]);
    energy += double(exchange) * double(exchange) / area2;
    noise += variance_of(s, i, j, exchange);
  });
  return energy - square_sum(coupling) <= limit_of(s, block) + double(s.params.noise) * noise;
}

/// The larger of two clusters is halved, both when they are about as large.
struct Halving {
  bool rows = false, columns = false;
};
Halving halving_of(const Source& s, const Block& block) {
  const Cluster& r = s.clusters[block.receiver];
  const Cluster& c = s.clusters[block.sender];
  const float row_m = s.ball[block.receiver].radius_m, column_m = s.ball[block.sender].radius_m;
  const bool rows = !r.is_leaf() && (c.is_leaf() || row_m > 0.6f * column_m);
  const bool columns = !c.is_leaf() && (r.is_leaf() || column_m > 0.6f * row_m);
  return {rows, columns};
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
  if (is_smooth(s, block, coupling, coupled)) {
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

/// The functions of clusters in terms of those of their halves.
std::vector<Hierarchical::Up> make_up(const Source& s) {
  std::vector<Hierarchical::Up> up(s.clusters.size(), Hierarchical::Up{});
  for (const Cluster& parent : s.clusters) {
    const auto& own = s.phi[parent.depth];
    for (uint32_t child = parent.child; child != 0 && child < parent.child + 2; ++child) {
      const auto& part = s.phi[parent.depth + 1];
      for (size_t a = 0; a < kFunctions; ++a)
        for (size_t b = 0; b < kFunctions; ++b)
          for (uint32_t i = s.clusters[child].first; i < s.clusters[child].end; ++i)
            up[child][kLanes * b + a] += s.area_m2[i] * own[i][a] * part[i][b];
    }
  }
  return up;
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
  out.up = make_up(s);
  out.phi.resize(s.area_m2.size());
  for (const Cluster& c : s.clusters)
    if (c.is_leaf())
      for (uint32_t i = c.first; i < c.end; ++i) out.phi[i] = s.phi[c.depth][i];
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
  if (progress.cancelled()) return fail(ErrorCode::cancelled, "cancelled");
  return assemble(source, found);
}

uint64_t bytes_of(const Hierarchical& m) {
  const auto bytes = [](const auto& v) { return uint64_t(v.size() * sizeof(v[0])); };
  return bytes(m.clusters) + bytes(m.up) + bytes(m.phi) + bytes(m.area_m2) + bytes(m.first_far) +
         bytes(m.far) + bytes(m.first_near) + bytes(m.near) + bytes(m.entries);
}

}  // namespace luxel::matrix
