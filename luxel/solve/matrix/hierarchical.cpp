#include "luxel/solve/matrix/hierarchical.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "luxel/base/check.h"
#include "luxel/base/parallel.h"
#include "luxel/solve/matrix/found_blocks.h"

namespace luxel::matrix {
namespace {

/// Clusters whose centres are nearer than this part of their radii's sum touch or overlap: what
/// they exchange is not smooth, even where it seems so.
constexpr float kTouching = 0.75f;

bool touching(const CouplingSource& s, const Block& block) {
  const Ball& a = s.functions.ball[block.receiver];
  const Ball& b = s.functions.ball[block.sender];
  return length(a.centre - b.centre) < kTouching * (a.radius_m + b.radius_m);
}

/// Energy that a block may lose. Light of 1 on all of a cluster has the energy of its area, so the
/// loss of a block of large clusters counts for more.
double limit_of(const CouplingSource& s, const Block& block, double block_error) {
  const double area = 0.5 * (s.cluster_m2[block.receiver] + s.cluster_m2[block.sender]);
  return block_error * block_error * s.leaf_m2 / area;
}

/// A block loses no more than its limit and a part of its noise.
bool is_smooth(const CouplingSource& s, const HierarchicalParams& params, const FarBlock& far) {
  return far.lost <=
         limit_of(s, far.block, double(params.block_error)) + double(params.noise) * far.noise;
}

/// Two clusters whose radii are in a ratio above this are about as large. Halves of a surface have
/// 1 / sqrt 2 = 0.71 of its radius: clusters one level apart still are, those two levels apart
/// (0.5) are not.
constexpr float kAboutAsLarge = 0.6f;

/// The larger of two clusters is halved, both when they are about as large.
struct Halving {
  bool rows = false, columns = false;
};
Halving halving_of(const CouplingSource& s, const Block& block) {
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

bool has_two_halves(const CouplingSource& s, const Parts& parts, uint32_t cluster) {
  if (parts.count == 1) return true;
  const auto [a, b] = parts.cluster;
  return std::min(s.cluster_m2[a], s.cluster_m2[b]) >= kLeastHalf * s.cluster_m2[cluster];
}

/// A walk down the blocks of a task.
struct Walk {
  const CouplingSource& source;
  const HierarchicalParams& params;
  FoundBlocks& out;
  /// Entries of the rows of the block that is looked at, above those of the blocks that it is a
  /// part of.
  std::vector<RowRange> ranges;
};

/// The ranges of a block, which begin at `at`.
std::span<RowRange> ranges_of(Walk& w, const Block& block, size_t at) {
  return std::span(w.ranges).subspan(at, w.source.clusters[block.receiver].size());
}

/// Entries of a leaf pair in 8 bits. What rounding takes from one sender's the next gets, so that
/// the sum over a row is kept.
void append_near(Walk& w, const Block& block, size_t at) {
  const uint32_t senders = w.source.clusters[block.sender].size();
  std::array<float, size_t(kLeafSize) * kLeafSize> room;
  const std::span<float> value(room.data(), size_t(kLeafSize) * senders);
  near_entries(w.source, block, ranges_of(w, block, at), value);
  const float scale = *std::max_element(value.begin(), value.end()) / 255;
  w.out.near.push_back({block, scale, w.out.entries.size()});
  std::array<float, kLeafSize> carried{};
  for (size_t j = 0; j < senders; ++j)
    for (size_t i = 0; i < kLeafSize; ++i) {
      const float wanted = value[j * kLeafSize + i] / std::max(scale, 1e-30f) + carried[i];
      const float kept = std::clamp(std::round(wanted), 0.0f, 255.0f);
      carried[i] = wanted - kept;
      w.out.entries.push_back(uint8_t(kept));
    }
}

/// A pair of leaves, whose functions may see all but little of the entries between them.
void visit_leaves(Walk& w, const Block& block, const Coupling& coupling, size_t at) {
  if (!touching(w.source, block)) {
    const Energy all = energy_of(w.source, block, ranges_of(w, block, at));
    const FarBlock far{block, coupling, all.entries - square_sum(coupling), all.noise};
    if (is_smooth(w.source, w.params, far)) return w.out.far.push_back(far);
  }
  append_near(w, block, at);
}

/// The energy that the parts of a block see.
double energy_of(const Coupled& parts) {
  double energy = 0;
  for (const auto& row : parts.part)
    for (const Coupling& part : row) energy += square_sum(part);
  return energy;
}

void visit_parts(Walk& w, const Block& block, const Coupled& coupled, const Parts& rows,
                 const Parts& columns, size_t at);

/// A block whose rows' entries are the ranges from `at` on: far as it is, or its parts.
void visit(Walk& w, const Block& block, const Coupling& coupling, size_t at) {
  const CouplingSource& s = w.source;
  const Halving halving = halving_of(s, block);
  if (!halving.rows && !halving.columns) return visit_leaves(w, block, coupling, at);
  const Parts rows = parts_of(s, block.receiver, halving.rows);
  const Parts columns = parts_of(s, block.sender, halving.columns);
  const Coupled coupled = couple(s, block, rows, columns, ranges_of(w, block, at));
  const bool telling = has_two_halves(s, rows, block.receiver) &&
                       has_two_halves(s, columns, block.sender) && !touching(s, block);
  const FarBlock far{block, coupling, energy_of(coupled) - square_sum(coupling), coupled.noise};
  if (telling && is_smooth(s, w.params, far)) return w.out.far.push_back(far);
  visit_parts(w, block, coupled, rows, columns, at);
}

void visit_parts(Walk& w, const Block& block, const Coupled& coupled, const Parts& rows,
                 const Parts& columns, size_t at) {
  const uint32_t first = w.source.clusters[block.receiver].first;
  const size_t top = at + w.source.clusters[block.receiver].size();
  for (uint32_t r = 0; r < rows.count; ++r)
    for (uint32_t c = 0; c < columns.count; ++c) {
      if (coupled.entries[r][c] == 0) continue;
      const Block part{rows.cluster[r], columns.cluster[c]};
      const Cluster& receiver = w.source.clusters[part.receiver];
      w.ranges.resize(top);
      for (uint32_t i = receiver.first; i < receiver.end; ++i) {
        const RowRange whole = w.ranges[at + (i - first)];
        if (c == 0)
          w.ranges.push_back({whole.begin, whole.middle, whole.middle});
        else
          w.ranges.push_back({whole.middle, whole.end, whole.end});
      }
      visit(w, part, coupled.part[r][c], top);
    }
}

/// The ranges of a block that is met from outside.
void enter(Walk& w, const Block& block) {
  w.ranges.resize(w.source.clusters[block.receiver].size());
  find_ranges(w.source, block, w.ranges);
}

/// Walks from (receiver, all) down: blocks above the receiver's depth are never smooth enough.
void visit_receiver(Walk& w, uint32_t receiver, uint32_t sender) {
  const CouplingSource& s = w.source;
  const Cluster& c = s.clusters[sender];
  if (c.depth < s.clusters[receiver].depth && !c.is_leaf()) {
    visit_receiver(w, receiver, c.child);
    visit_receiver(w, receiver, c.child + 1);
    return;
  }
  const Block block{receiver, sender};
  enter(w, block);
  const Coupled whole = couple(s, block, parts_of(s, receiver, false), parts_of(s, sender, false),
                               ranges_of(w, block, 0));
  if (whole.entries[0][0] > 0) visit(w, block, whole.part[0][0], 0);
}

/// Divides those far blocks of a task that are smooth no longer.
void divide(Walk& w) {
  const std::vector<FarBlock> before = std::exchange(w.out.far, {});
  for (const FarBlock& far : before) {
    if (is_smooth(w.source, w.params, far)) {
      w.out.far.push_back(far);
      continue;
    }
    enter(w, far.block);
    visit(w, far.block, far.coupling, 0);
  }
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

/// All but the blocks.
Hierarchical without_blocks(const CouplingSource& s) {
  Hierarchical out;
  out.clusters.assign(s.clusters.begin(), s.clusters.end());
  out.area_m2.assign(s.area_m2.begin(), s.area_m2.end());
  out.up = make_up(s.functions, s.clusters, s.area_m2);
  out.phi.resize(s.area_m2.size());
  for (const Cluster& c : s.clusters)
    if (c.is_leaf())
      for (uint32_t i = c.first; i < c.end; ++i) out.phi[i] = s.functions.phi[c.depth][i];
  return out;
}

}  // namespace

struct Compression::State {
  CouplingSource source;
  Hierarchical frame;                              ///< all but the blocks
  std::vector<uint32_t> receivers;                 ///< per task
  std::vector<FoundBlocks> found;                  ///< per task
  bool is_first = true;                            ///< no step was taken
  float block_error = INFINITY, noise = INFINITY;  ///< of the last step
};

Compression::Compression(const FormFactors& factors, const ClusterTree& tree,
                         std::span<const Vec3> position, std::span<const float> area_m2,
                         int rays_per_patch) {
  LUXEL_CHECK(position.size() == factors.size() && area_m2.size() == factors.size());
  for (const Cluster& c : tree.clusters) LUXEL_CHECK(!c.is_leaf() || c.size() <= kLeafSize);
  state_ = std::make_unique<State>(State{
      make_coupling_source(factors, tree.clusters, position, area_m2, rays_per_patch), {}, {}, {}});
  state_->frame = without_blocks(state_->source);
  state_->receivers = task_receivers(tree.clusters);
}

Compression::~Compression() = default;

Result<Hierarchical> Compression::step(const HierarchicalParams& params, Progress& progress) {
  State& s = *state_;
  LUXEL_CHECK(params.block_error <= s.block_error && params.noise <= s.noise);
  s.block_error = params.block_error, s.noise = params.noise;
  const bool is_first = std::exchange(s.is_first, false);
  progress.begin("compress", s.receivers.size());
  s.found.resize(s.receivers.size());
  parallel_for(s.receivers.size(), 1, [&](size_t begin, size_t end) {
    for (size_t k = begin; k < end && !progress.cancelled(); ++k) {
      Walk walk{s.source, params, s.found[k], {}};
      if (is_first)
        visit_receiver(walk, s.receivers[k], 0);
      else
        divide(walk);
      sort_blocks(s.source, s.found[k]);
      progress.advance(1);
    }
  });
  LUXEL_TRY_STATUS(stopped(progress));
  Hierarchical out = s.frame;
  assemble(s.source, s.found, out);
  return out;
}

Result<Hierarchical> compress(const FormFactors& factors, const ClusterTree& tree,
                              std::span<const Vec3> position, std::span<const float> area_m2,
                              const HierarchicalParams& params, Progress& progress) {
  return Compression(factors, tree, position, area_m2, params.rays_per_patch)
      .step(params, progress);
}

uint64_t bytes_of(const Hierarchical& m) {
  const auto bytes = [](const auto& v) { return uint64_t(v.size() * sizeof(v[0])); };
  return bytes(m.clusters) + bytes(m.up) + bytes(m.phi) + bytes(m.area_m2) + bytes(m.first_far) +
         bytes(m.far) + bytes(m.first_near) + bytes(m.near) + bytes(m.entries);
}

}  // namespace luxel::matrix
