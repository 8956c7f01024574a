#include "post/noise_level.h"

#include "base/parallel.h"

namespace luxel::post {
namespace {

/// Means are taken over texels so far away, about 37 of them: a mean of squares is then known to a
/// quarter.
constexpr float kWindow = 3.5f;
/// Fewer differences than these say nothing.
constexpr float kMinDifferences = 8;

struct Difference {
  Rgb squared;
  float luminance2 = -1;  ///< < 0: a neighbour is missing
};

/// The mixed second difference at texel i.
Difference mixed_difference(const Neighbourhood& n, uint32_t i, std::span<const Rgb> values) {
  constexpr float kMask[3][3] = {{1, -2, 1}, {-2, 4, -2}, {1, -2, 1}};
  const atlas::TexelMap& map = *n.map;
  const atlas::Texel& t = map.texels[i];
  const int side = map.resolution;
  if (t.x < 1 || t.y < 1 || int(t.x) + 1 >= side || int(t.y) + 1 >= side) return {};
  const Frame frame = frame_around(n.place[i].normal);
  Rgb sum{};
  for (int dy = -1; dy <= 1; ++dy)
    for (int dx = -1; dx <= 1; ++dx) {
      const uint32_t j = map.texel_at[size_t(int(t.y) + dy) * size_t(side) + size_t(int(t.x) + dx)];
      // A neighbour in the atlas that is one in the world, too: three texels, for stretched charts.
      if (j == atlas::kNone ||
          neighbour(n.place[i], n.place[j], frame, 3, n.min_cosine).weight <= 0)
        return {};
      sum += values[j] * kMask[dy + 1][dx + 1];
    }
  const Rgb r = sum / 6;
  const float l = luminance(r);
  return {r * r, l * l};
}

/// Light with edges shows more than noise, but most texels have none: what stratification gains is
/// about the same everywhere, and no texel is taken to be noisier than this many times the median
/// of what its solver states times that gain.
constexpr float kAboveMedian = 3;

/// The median of shown over stated variance, texels weighted by what is stated; at most 1. A
/// squared normal variable has the median 0.455.
float median_gain(std::span<const Difference> differences, std::span<const float> stated) {
  std::vector<std::pair<float, float>> ratios;
  double total = 0, sum = 0;
  for (size_t i = 0; i < stated.size(); ++i)
    if (stated[i] > 0 && differences[i].luminance2 >= 0) {
      ratios.push_back({differences[i].luminance2 / stated[i], stated[i]});
      total += double(stated[i]);
    }
  std::sort(ratios.begin(), ratios.end());
  for (const auto& [ratio, weight] : ratios)
    if ((sum += double(weight)) >= total / 2) return std::min(1.0f, ratio / 0.455f);
  return 1;
}

struct Means {
  float stated = 0, weight = 0;                  ///< the solver's variance
  float shown = 0, shown_weight = 0, count = 0;  ///< r^2 of luminance
  Rgb shown_channels{}, light{};
};

}  // namespace

NoiseLevel noise_level(const Neighbourhood& n, std::span<const Rgb> values,
                       std::span<const float> variance) {
  std::vector<Difference> difference(values.size());
  parallel_for(values.size(), kBlockTexels, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i)
      if (n.place[i].spacing > 0) difference[i] = mixed_difference(n, uint32_t(i), values);
  });
  const float most = std::min(1.0f, kAboveMedian * median_gain(difference, variance));
  NoiseLevel level;
  level.variance.assign(values.size(), 0.0f);
  level.per_channel.assign(values.size(), {1, 1, 1});
  parallel_for(values.size(), kBlockTexels, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      if (n.place[i].spacing <= 0) continue;
      Means m;
      for_neighbours(n, uint32_t(i), frame_around(n.place[i].normal), kWindow,
                     [&](uint32_t j, const Neighbour& at) {
                       m.stated += at.weight * variance[j], m.weight += at.weight;
                       m.light += values[j] * at.weight;
                       if (difference[j].luminance2 < 0) return;
                       m.shown += at.weight * difference[j].luminance2;
                       m.shown_channels += difference[j].squared * at.weight;
                       m.shown_weight += at.weight, m.count += 1;
                     });
      level.variance[i] = most * m.stated / m.weight;
      if (m.count >= kMinDifferences && m.shown > 0) {
        level.variance[i] = std::min(level.variance[i], m.shown / m.shown_weight);
        level.per_channel[i] = m.shown_channels / m.shown;
      } else if (const float l = luminance(m.light); l > 0) {
        // Noise that is as large a part of each channel.
        level.per_channel[i] = (m.light / l) * (m.light / l);
      }
    }
  });
  return level;
}

}  // namespace luxel::post
