// E = F B through the hierarchy: up, across, down.
#include <algorithm>

#include "base/check.h"
#include "base/parallel.h"
#include "base/vectorize.h"
#include "solve/matrix/hierarchical.h"

namespace luxel::matrix {
namespace {

/// to += matrix * from, channel by channel; the matrix column by column.
template <class Number>
inline void add_product(const Number* matrix, const float* from, float scale, float* to) {
  for (uint32_t channel = 0; channel < 3; ++channel)
    for (uint32_t b = 0; b < kFunctions; ++b) {
      const float factor = scale * from[kLanes * channel + b];
      for (uint32_t a = 0; a < kLanes; ++a)
        to[kLanes * channel + a] += float(matrix[kLanes * b + a]) * factor;
    }
}

void clear(Moments& moments) { moments.fill(0.0f); }

/// Moments of leaves [begin, end).
void send_leaves(const Hierarchical& m, std::span<const Rgb> radiosity, size_t begin, size_t end,
                 std::span<Moments> sent) {
  for (size_t c = begin; c < end; ++c) {
    clear(sent[c]);
    if (!m.clusters[c].is_leaf()) continue;
    for (uint32_t i = m.clusters[c].first; i < m.clusters[c].end; ++i)
      for (int channel = 0; channel < 3; ++channel) {
        const float power = radiosity[i][channel] * m.area_m2[i];
        for (uint32_t a = 0; a < kFunctions; ++a)
          sent[c][kLanes * size_t(channel) + a] += power * m.phi[i][a];
      }
  }
}

LUXEL_VECTOR_CLONES
void send_up(const Hierarchical& m, std::span<Moments> sent) {
  for (size_t p = m.clusters.size(); p-- > 0;)
    for (uint32_t c = m.clusters[p].child; c != 0 && c < m.clusters[p].child + 2; ++c)
      add_product(m.up[c].data(), sent[c].data(), 1.0f, sent[p].data());
}

LUXEL_VECTOR_CLONES
void receive_far(const Hierarchical& m, std::span<const Moments> sent, size_t begin, size_t end,
                 std::span<Moments> received) {
  for (size_t c = begin; c < end; ++c) {
    float sum[3 * kLanes] = {};
    for (uint32_t k = m.first_far[c]; k < m.first_far[c + 1]; ++k)
      add_product(m.far[k].coefficient.data(), sent[m.far[k].sender].data(), m.far[k].scale, sum);
    std::copy(std::begin(sum), std::end(sum), received[c].begin());
  }
}

/// From clusters to their halves: the transposed matrix.
LUXEL_VECTOR_CLONES
void hand_down(const Hierarchical& m, std::span<Moments> received) {
  for (size_t p = 0; p < m.clusters.size(); ++p)
    for (uint32_t c = m.clusters[p].child; c != 0 && c < m.clusters[p].child + 2; ++c)
      for (uint32_t channel = 0; channel < 3; ++channel)
        for (uint32_t b = 0; b < kFunctions; ++b) {
          float sum = 0;
          for (uint32_t a = 0; a < kFunctions; ++a)
            sum += m.up[c][kLanes * b + a] * received[p][kLanes * channel + a];
          received[c][kLanes * channel + b] += sum;
        }
}

/// Adds what a leaf's patches receive from near ones.
LUXEL_VECTOR_CLONES
void receive_near(const Hierarchical& m, size_t leaf, std::span<const Rgb> radiosity,
                  float (*sums)[kLeafSize]) {
  for (uint32_t k = m.first_near[leaf]; k < m.first_near[leaf + 1]; ++k) {
    const Hierarchical::Near& near = m.near[k];
    const Cluster& sender = m.clusters[near.sender];
    const uint8_t* entry = m.entries.data() + near.entry;
    for (uint32_t j = sender.first; j < sender.end; ++j, entry += kLeafSize) {
      const Rgb b = radiosity[j] * near.scale;
      for (uint32_t i = 0; i < kLeafSize; ++i) {
        const float f = float(entry[i]);
        sums[0][i] += f * b.x;
        sums[1][i] += f * b.y;
        sums[2][i] += f * b.z;
      }
    }
  }
}

void receive_leaves(const Hierarchical& m, std::span<const Rgb> radiosity,
                    std::span<const Moments> received, size_t begin, size_t end,
                    std::span<Rgb> irradiance) {
  for (size_t c = begin; c < end; ++c) {
    const Cluster& leaf = m.clusters[c];
    if (!leaf.is_leaf()) continue;
    float sums[3][kLeafSize] = {};
    receive_near(m, c, radiosity, sums);
    for (uint32_t i = leaf.first; i < leaf.end; ++i) {
      Rgb sum{sums[0][i - leaf.first], sums[1][i - leaf.first], sums[2][i - leaf.first]};
      for (uint32_t a = 0; a < kFunctions; ++a)
        sum +=
            m.phi[i][a] * Rgb{received[c][a], received[c][kLanes + a], received[c][2 * kLanes + a]};
      irradiance[i] = max(sum, Rgb{});  // smooth functions may fall below nothing
    }
  }
}

}  // namespace

HierarchicalWork make_work(const Hierarchical& matrix) {
  HierarchicalWork work;
  work.sent.resize(matrix.clusters.size()), work.received.resize(matrix.clusters.size());
  return work;
}

void multiply(const Hierarchical& m, std::span<const Rgb> radiosity, std::span<Rgb> irradiance,
              HierarchicalWork& work) {
  LUXEL_CHECK(radiosity.size() == m.size() && irradiance.size() == m.size());
  const size_t clusters = m.clusters.size();
  const auto send = [&](size_t begin, size_t end) {
    send_leaves(m, radiosity, begin, end, work.sent);
  };
  parallel_for(clusters, 512, std::ref(send));
  send_up(m, work.sent);
  const auto far = [&](size_t begin, size_t end) {
    receive_far(m, work.sent, begin, end, work.received);
  };
  parallel_for(clusters, 64, std::ref(far));
  hand_down(m, work.received);
  const auto leaves = [&](size_t begin, size_t end) {
    receive_leaves(m, radiosity, work.received, begin, end, irradiance);
  };
  parallel_for(clusters, 128, std::ref(leaves));
}

}  // namespace luxel::matrix
