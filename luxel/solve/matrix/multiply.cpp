// E = F B through the hierarchy: up, across, down.
#include <algorithm>

#include "luxel/base/check.h"
#include "luxel/base/parallel.h"
#include "luxel/base/vectorize.h"
#include "luxel/solve/matrix/hierarchical.h"

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

void spread(std::span<const Moments> sent, size_t begin, size_t end, std::span<SpreadMoments> out) {
  for (size_t c = begin; c < end; ++c)
    for (uint32_t channel = 0; channel < 3; ++channel)
      for (uint32_t k = 0; k < kWords; ++k)
        out[c][kWords * channel + k] =
            k < kLanes * kFunctions ? sent[c][kLanes * channel + k / kLanes] : 0.0f;
}

/// A block is read as a whole, 16 words at once: its last four words, which are its scale and its
/// sender, meet zeros.
LUXEL_WIDE_VECTOR_CLONES
void receive_far(const Hierarchical& m, std::span<const SpreadMoments> sent, size_t begin,
                 size_t end, std::span<Moments> received) {
  static_assert(kWords == 16 && kFunctions == 3);
  for (size_t c = begin; c < end; ++c) {
    Float16 sum[3] = {};  // functions b = 0, 1, 2, channel by channel
    for (uint32_t k = m.first_far[c]; k < m.first_far[c + 1]; ++k) {
      const Hierarchical::Far& far = m.far[k];
      const float* from = sent[far.sender].data();
      Float16 block, x;
      load16(reinterpret_cast<const int16_t*>(&far), block);
      block *= far.scale;
      for (uint32_t channel = 0; channel < 3; ++channel) {
        load16(from + kWords * channel, x);
        sum[channel] += block * x;
      }
    }
    for (uint32_t channel = 0; channel < 3; ++channel)
      for (uint32_t a = 0; a < kLanes; ++a)
        received[c][kLanes * channel + a] =
            sum[channel][a] + sum[channel][kLanes + a] + sum[channel][2 * kLanes + a];
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

/// Irradiance of a leaf's patches from near ones, channel by channel.
LUXEL_VECTOR_CLONES
void receive_near(const Hierarchical& m, size_t leaf, std::span<const Rgb> radiosity,
                  float (*out)[kLeafSize]) {
  static_assert(kLeafSize == 8);
  Float8 red = {}, green = {}, blue = {};
  for (uint32_t k = m.first_near[leaf]; k < m.first_near[leaf + 1]; ++k) {
    const Hierarchical::Near& near = m.near[k];
    const Cluster& sender = m.clusters[near.sender];
    const uint8_t* entry = m.entries.data() + near.entry;
    for (uint32_t j = sender.first; j < sender.end; ++j, entry += kLeafSize) {
      const Rgb b = radiosity[j] * near.scale;
      Float8 f;
      load8(entry, f);
      red += f * b.x, green += f * b.y, blue += f * b.z;
    }
  }
  store8(red, out[0]), store8(green, out[1]), store8(blue, out[2]);
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

HierarchicalScratch make_scratch(const Hierarchical& matrix) {
  HierarchicalScratch scratch;
  scratch.sent.resize(matrix.clusters.size()), scratch.received.resize(matrix.clusters.size());
  scratch.spread.resize(matrix.clusters.size());
  return scratch;
}

void multiply(const Hierarchical& m, std::span<const Rgb> radiosity, std::span<Rgb> irradiance,
              HierarchicalScratch& scratch) {
  LUXEL_CHECK(radiosity.size() == m.size() && irradiance.size() == m.size());
  const size_t clusters = m.clusters.size();
  const auto send = [&](size_t begin, size_t end) {
    send_leaves(m, radiosity, begin, end, scratch.sent);
  };
  parallel_for(clusters, 512, std::ref(send));
  send_up(m, scratch.sent);
  const auto widen = [&](size_t begin, size_t end) {
    spread(scratch.sent, begin, end, scratch.spread);
  };
  parallel_for(clusters, 512, std::ref(widen));
  const auto far = [&](size_t begin, size_t end) {
    receive_far(m, scratch.spread, begin, end, scratch.received);
  };
  parallel_for(clusters, 64, std::ref(far));
  hand_down(m, scratch.received);
  const auto leaves = [&](size_t begin, size_t end) {
    receive_leaves(m, radiosity, scratch.received, begin, end, irradiance);
  };
  parallel_for(clusters, 128, std::ref(leaves));
}

}  // namespace luxel::matrix
