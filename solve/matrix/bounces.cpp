#include "solve/matrix/bounces.h"

#include <Eigen/LU>
#include <algorithm>
#include <map>
#include <numeric>

#include "base/check.h"
#include "base/parallel.h"
#include "base/vectorize.h"

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

/// Patches that light can go between, over others, have the same number: the least of theirs.
std::vector<uint32_t> components_of(const FormFactors& factors) {
  std::vector<uint32_t> root(factors.size());
  std::iota(root.begin(), root.end(), 0u);
  const auto root_of = [&](uint32_t i) {
    while (root[i] != i) i = root[i] = root[root[i]];
    return i;
  };
  for (uint32_t i = 0; i < factors.size(); ++i)
    for (const uint32_t j : factors.columns_of(i)) {
      const uint32_t a = root_of(i), b = root_of(j);
      root[std::max(a, b)] = std::min(a, b);
    }
  for (uint32_t i = 0; i < factors.size(); ++i) root[i] = root_of(i);
  // Those that see no other do no harm wherever they are.
  for (uint32_t i = 0; i < factors.size(); ++i)
    if (factors.columns_of(i).empty()) root[i] = 0;
  return root;
}

/// Numbers the clusters of a cut, each component of the scene for itself: what is inside a closed
/// box must not share a cluster with what is outside. Returns how many.
uint32_t number_clusters(const FormFactors& factors, const ClusterTree& tree,
                         std::span<const uint32_t> cut, std::vector<uint32_t>& cluster_of) {
  const std::vector<uint32_t> component = components_of(factors);
  cluster_of.resize(factors.size());
  uint32_t count = 0;
  std::map<uint32_t, uint32_t> number;
  for (const uint32_t c : cut) {
    number.clear();
    for (uint32_t i = tree.clusters[c].first; i < tree.clusters[c].end; ++i) {
      const auto [entry, is_new] = number.try_emplace(component[i], count);
      count += is_new;
      cluster_of[i] = entry->second;
    }
  }
  return count;
}

}  // namespace

CoarseScene make_coarse_scene(const FormFactors& factors, const ClusterTree& tree,
                              std::span<const float> area_m2, std::span<const Rgb> reflectance,
                              size_t clusters) {
  CoarseScene out;
  const uint32_t count = number_clusters(factors, tree, cut_of(tree, clusters), out.cluster_of);
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

BounceWork make_bounce_work(size_t patches, size_t clusters) {
  BounceWork work;
  for (std::vector<Rgb>* v : {&work.first, &work.radiosity, &work.gathered}) v->resize(patches);
  for (std::vector<Rgb>* v : {&work.power, &work.late}) v->resize(clusters);
  return work;
}

void count_bounces(const Multiply& multiply, std::span<const Rgb> reflectance,
                   std::span<const Rgb> sent, int bounces, std::span<Rgb> irradiance,
                   BounceWork& work) {
  std::fill(irradiance.begin(), irradiance.end(), Rgb{});
  for (int k = 0; k < bounces; ++k) {
    for (size_t i = 0; i < sent.size(); ++i)
      work.radiosity[i] = sent[i] + reflectance[i] * irradiance[i];
    multiply(work.radiosity, irradiance);
  }
}

namespace {

/// Clusters that a task takes.
constexpr size_t kRows = 64;

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
void late_bounces(const CoarseScene& coarse, std::span<const Rgb> reflectance,
                  std::span<const float> area_m2, std::span<const Rgb> arriving, BounceWork& work) {
  std::fill(work.power.begin(), work.power.end(), Rgb{});
  for (size_t i = 0; i < arriving.size(); ++i)
    work.power[coarse.cluster_of[i]] += reflectance[i] * arriving[i] * area_m2[i];
  const auto rows = [&](size_t begin, size_t end) {
    float sum[3][kRows] = {};
    for (int channel = 0; channel < 3; ++channel)
      respond(coarse.response[size_t(channel)], coarse.count(), work.power, channel, begin, end,
              sum[channel]);
    for (size_t s = begin; s < end; ++s)
      work.late[s] = {sum[0][s - begin], sum[1][s - begin], sum[2][s - begin]};
  };
  parallel_for(coarse.count(), kRows, std::ref(rows));
}

}  // namespace

void all_bounces(const Multiply& multiply, const CoarseScene& coarse,
                 std::span<const Rgb> reflectance, std::span<const float> area_m2,
                 std::span<const Rgb> sent, int sweeps, std::span<Rgb> irradiance,
                 BounceWork& work) {
  LUXEL_CHECK(sweeps >= 1);
  multiply(sent, work.first);
  std::copy(work.first.begin(), work.first.end(), irradiance.begin());
  // `gathered` is what came in anew: first all, then what the sweep before did not foresee.
  std::copy(work.first.begin(), work.first.end(), work.gathered.begin());
  for (int k = 1; k < sweeps; ++k) {
    late_bounces(coarse, reflectance, area_m2, work.gathered, work);
    for (size_t i = 0; i < irradiance.size(); ++i) {
      irradiance[i] += work.late[coarse.cluster_of[i]];
      work.radiosity[i] = reflectance[i] * irradiance[i];
    }
    multiply(work.radiosity, work.gathered);
    for (size_t i = 0; i < irradiance.size(); ++i) {
      const Rgb now = work.first[i] + work.gathered[i];
      work.gathered[i] = now - irradiance[i];
      irradiance[i] = now;
    }
  }
}

}  // namespace luxel::matrix
