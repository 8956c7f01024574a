#include "luxel/solve/matrix/bounces.h"

#include <Eigen/LU>
#include <algorithm>
#include <utility>

#include "luxel/base/check.h"
#include "luxel/base/parallel.h"
#include "luxel/base/vectorize.h"

namespace luxel::matrix {
namespace {

/// The smallest depth with `wanted` clusters, counting leaves above it.
std::vector<uint32_t> cut_of(const ClusterTree& tree, size_t wanted) {
  std::vector<uint32_t> cut{0};
  while (cut.size() < wanted) {
    std::vector<uint32_t> next;
    for (const uint32_t c : cut)
      if (tree.clusters[c].is_leaf())
        next.push_back(c);
      else
        next.push_back(tree.clusters[c].child), next.push_back(tree.clusters[c].child + 1);
    if (next.size() == cut.size()) break;
    cut = std::move(next);
  }
  return cut;
}

/// Form factors of each patch to clusters of a cut, ascending by cluster.
struct Views {
  struct Share {
    uint32_t cluster = 0;
    float factor = 0;
  };
  std::vector<Share> share;
  std::vector<size_t> first;  ///< per patch, one extra entry

  std::span<const Share> of(size_t patch) const {
    return std::span(share).subspan(first[patch], first[patch + 1] - first[patch]);
  }
};

Views views_of(const FormFactors& factors, std::span<const uint32_t> cluster_of, size_t clusters) {
  Views out;
  std::vector<float> sum(clusters);
  std::vector<uint32_t> seen;
  for (size_t i = 0; i < factors.size(); ++i) {
    out.first.push_back(out.share.size());
    const auto columns = factors.columns_of(i);
    for (size_t k = 0; k < columns.size(); ++k) {
      const uint32_t c = cluster_of[columns[k]];
      if (sum[c] == 0) seen.push_back(c);
      sum[c] += factors.factors_of(i)[k];
    }
    std::sort(seen.begin(), seen.end());
    for (const uint32_t c : seen) out.share.push_back({c, std::exchange(sum[c], 0.0f)});
    seen.clear();
  }
  out.first.push_back(out.share.size());
  return out;
}

/// The part that two views share: sum of the smaller factors.
float common_view(std::span<const Views::Share> a, std::span<const Views::Share> b) {
  float sum = 0;
  for (size_t i = 0, j = 0; i < a.size() && j < b.size();) {
    if (a[i].cluster == b[j].cluster) sum += std::min(a[i].factor, b[j].factor);
    const bool next_a = a[i].cluster <= b[j].cluster, next_b = b[j].cluster <= a[i].cluster;
    i += next_a, j += next_b;
  }
  return sum;
}

/// Two patches of a cluster whose views share less than this are not alike; a cluster is split into
/// no more parts than are worth their room.
constexpr float kAlikeViews = 0.35f;
constexpr size_t kMostParts = 3;

/// The part that a patch joins: the first that it is like; when there can be no more parts, the one
/// it is most like. model.size(): a new one.
size_t part_of(const Views& views, uint32_t patch, std::span<const uint32_t> model) {
  const auto view = views.of(patch);
  if (view.empty()) return 0;  // does no harm wherever it is
  size_t best = 0;
  float most = -1;
  for (size_t part = 0; part < model.size(); ++part) {
    const float common = common_view(view, views.of(model[part]));
    if (common >= kAlikeViews) return part;
    if (common > most) most = common, best = part;
  }
  return model.size() < kMostParts ? model.size() : best;
}

/// Splits clusters whose patches see different things: the floors on both sides of a wall, what is
/// inside and what is outside of a box. Returns how many clusters there are.
uint32_t split_by_view(const FormFactors& factors, const ClusterTree& tree,
                       std::span<const uint32_t> cut, std::vector<uint32_t>& cluster_of) {
  cluster_of.resize(factors.size());
  for (uint32_t s = 0; s < cut.size(); ++s)
    for (uint32_t i = tree.clusters[cut[s]].first; i < tree.clusters[cut[s]].end; ++i)
      cluster_of[i] = s;
  const Views views = views_of(factors, cluster_of, cut.size());
  uint32_t count = 0;
  std::vector<uint32_t> model;  // of each part of a cluster, one of its patches
  for (const uint32_t c : cut) {
    const Cluster& cluster = tree.clusters[c];
    model.clear();
    for (uint32_t i = cluster.first; i < cluster.end; ++i) {
      const size_t part = part_of(views, i, model);
      if (part == model.size()) model.push_back(i);
      cluster_of[i] = count + uint32_t(part);
    }
    count += uint32_t(model.size());
  }
  return count;
}

}  // namespace

CoarseScene make_coarse_scene(const FormFactors& factors, const ClusterTree& tree,
                              std::span<const float> area_m2, std::span<const Rgb> reflectance,
                              size_t clusters) {
  CoarseScene out;
  const uint32_t count = split_by_view(factors, tree, cut_of(tree, clusters), out.cluster_of);
  const auto m = Eigen::Index(count);
  out.area_m2.assign(count, 0.0f);
  for (size_t i = 0; i < factors.size(); ++i) out.area_m2[out.cluster_of[i]] += area_m2[i];
  // F_ST = sum A_i F_ij / A_S, and the mean reflectance of T.
  Eigen::MatrixXd exchange = Eigen::MatrixXd::Zero(m, m);
  std::vector<std::array<double, 3>> reflected(count, {0, 0, 0});
  for (size_t i = 0; i < factors.size(); ++i) {
    const auto columns = factors.columns_of(i);
    const auto values = factors.factors_of(i);
    const uint32_t s = out.cluster_of[i];
    for (size_t k = 0; k < columns.size(); ++k)
      exchange(s, out.cluster_of[columns[k]]) += double(values[k]) * double(area_m2[i]);
    for (int channel = 0; channel < 3; ++channel)
      reflected[s][size_t(channel)] += double(reflectance[i][channel]) * double(area_m2[i]);
  }
  for (size_t channel = 0; channel < 3; ++channel) {
    Eigen::MatrixXd system = Eigen::MatrixXd::Identity(m, m), first = exchange;
    for (Eigen::Index s = 0; s < m; ++s)
      for (Eigen::Index t = 0; t < m; ++t) {
        const double f = exchange(s, t) / double(out.area_m2[size_t(s)]);
        system(s, t) -= f * reflected[size_t(t)][channel] / double(out.area_m2[size_t(t)]);
        first(s, t) = f / double(out.area_m2[size_t(t)]);
      }
    const Eigen::MatrixXd response = system.partialPivLu().solve(first);
    for (Eigen::Index t = 0; t < m; ++t)
      for (Eigen::Index s = 0; s < m; ++s) out.response[channel].push_back(float(response(s, t)));
  }
  return out;
}

BounceScratch make_bounce_scratch(size_t patches, size_t clusters) {
  BounceScratch scratch;
  for (std::vector<Rgb>* v : {&scratch.first, &scratch.radiosity, &scratch.gathered})
    v->resize(patches);
  for (std::vector<Rgb>* v : {&scratch.power, &scratch.late}) v->resize(clusters);
  return scratch;
}

void count_bounces(const Multiply& multiply, const Sent& sent, std::span<Rgb> irradiance,
                   BounceScratch& scratch) {
  std::fill(irradiance.begin(), irradiance.end(), Rgb{});
  for (int k = 0; k < sent.bounces; ++k) {
    for (size_t i = 0; i < sent.radiosity.size(); ++i)
      scratch.radiosity[i] = sent.radiosity[i] + sent.reflectance[i] * irradiance[i];
    multiply(scratch.radiosity, irradiance);
  }
}

namespace {

/// Clusters that a task takes.
constexpr size_t kClustersPerTask = 64;

/// sum_S = sum_T response_ST q_T for the clusters [begin, end).
LUXEL_VECTOR_CLONES
void respond(const std::vector<float>& response, size_t count, std::span<const Rgb> power,
             int channel, size_t begin, size_t end, float* sum) {
  for (size_t t = 0; t < count; ++t) {
    const float q = power[t][channel];
    const float* column = response.data() + t * count;
    for (size_t s = begin; s < end; ++s) sum[s - begin] += column[s] * q;
  }
}

/// Late light per cluster, from the power that clusters reflect of `arriving`.
void late_bounces(const CoarseScene& coarse, const Sent& sent, std::span<const Rgb> arriving,
                  BounceScratch& scratch) {
  std::fill(scratch.power.begin(), scratch.power.end(), Rgb{});
  for (size_t i = 0; i < arriving.size(); ++i)
    scratch.power[coarse.cluster_of[i]] += sent.reflectance[i] * arriving[i] * sent.area_m2[i];
  const auto rows = [&](size_t begin, size_t end) {
    float sum[3][kClustersPerTask] = {};
    for (int channel = 0; channel < 3; ++channel)
      respond(coarse.response[size_t(channel)], coarse.count(), scratch.power, channel, begin, end,
              sum[channel]);
    for (size_t s = begin; s < end; ++s)
      scratch.late[s] = {sum[0][s - begin], sum[1][s - begin], sum[2][s - begin]};
  };
  parallel_for(coarse.count(), kClustersPerTask, std::ref(rows));
}

}  // namespace

void begin_sweeps(std::span<Rgb> irradiance, BounceScratch& scratch) {
  std::copy(scratch.first.begin(), scratch.first.end(), irradiance.begin());
  // `gathered` is what came in anew: first all, then what the sweep before did not foresee.
  std::copy(scratch.first.begin(), scratch.first.end(), scratch.gathered.begin());
}

void foresee(const CoarseScene& coarse, const Sent& sent, std::span<Rgb> irradiance,
             BounceScratch& scratch) {
  late_bounces(coarse, sent, scratch.gathered, scratch);
  for (size_t i = 0; i < irradiance.size(); ++i) {
    irradiance[i] += scratch.late[coarse.cluster_of[i]];
    scratch.radiosity[i] = sent.reflectance[i] * irradiance[i];
  }
}

void end_sweep(std::span<Rgb> irradiance, BounceScratch& scratch) {
  for (size_t i = 0; i < irradiance.size(); ++i) {
    const Rgb now = scratch.first[i] + scratch.gathered[i];
    scratch.gathered[i] = now - irradiance[i];
    irradiance[i] = now;
  }
}

void all_bounces(const Multiply& multiply, const CoarseScene& coarse, const Sent& sent, int sweeps,
                 std::span<Rgb> irradiance, BounceScratch& scratch) {
  LUXEL_CHECK(sweeps >= 1);
  multiply(sent.radiosity, scratch.first);
  begin_sweeps(irradiance, scratch);
  for (int k = 1; k < sweeps; ++k) {
    foresee(coarse, sent, irradiance, scratch);
    multiply(scratch.radiosity, scratch.gathered);
    end_sweep(irradiance, scratch);
  }
}

}  // namespace luxel::matrix
