#include "luxel/post/noise_level.h"

#include <algorithm>
#include <array>

#include "luxel/base/share_out.h"
#include "luxel/base/vectorize.h"

namespace luxel::post {
namespace {

/// Means are taken over texels so far away, about 37 of them: their median is then known
/// to a third.
constexpr float kWindow = 3.5f;
/// Fewer differences than these say nothing.
constexpr size_t kMinDifferences = 8;

/// The median of the square of a normal variable of variance 1.
constexpr float kMedianSquare = 0.455f;

/// Squares of a mixed second difference over the variance that is stated for it.
struct Difference {
  Rgb ratio;
  float luminance_ratio = -1;  ///< < 0: a neighbour is missing, or no noise is stated
};

/// The mixed second difference at texel i.
Difference mixed_difference(const Neighbourhood& n, uint32_t i, std::span<const Rgb> values,
                            std::span<const float> variance) {
  constexpr float kMask[3][3] = {{1, -2, 1}, {-2, 4, -2}, {1, -2, 1}};
  const atlas::TexelMap& map = *n.map;
  const atlas::Texel& t = map.texels[i];
  const int side = map.resolution;
  if (t.x < 1 || t.y < 1 || int(t.x) + 1 >= side || int(t.y) + 1 >= side) return {};
  // A neighbour in the atlas that is one in the world, too: three texels, for stretched charts.
  const Around self = around(n.place[i], 3, n.min_cosine);
  Rgb r{};
  float stated = 0;
  for (int dy = -1; dy <= 1; ++dy)
    for (int dx = -1; dx <= 1; ++dx) {
      const uint32_t j = map.texel_at[size_t(int(t.y) + dy) * size_t(side) + size_t(int(t.x) + dx)];
      if (j == atlas::kNone || neighbour(self, n.place[j]).weight <= 0) return {};
      const float k = kMask[dy + 1][dx + 1] / 6;
      r += values[j] * k;
      stated += k * k * variance[j];
    }
  if (!(stated > 0)) return {};
  const float l = luminance(r);
  return {r * r / stated, l * l / stated};
}

/// The values are so few that counting how many are less than each, eight at a time, is faster than
/// sorting.
LUXEL_VECTOR_CLONES
float median(std::span<const float> values) {
  const int middle = int(values.size() / 2);
  for (const float v : values) {
    int less = 0, up_to = 0;
    for (const float other : values) less += other < v, up_to += other <= v;
    if (less <= middle && middle < up_to) return v;
  }
  return 0;
}

/// Stated variances, light and differences of a window's texels.
struct Window {
  float stated = 0, weight = 0;
  Rgb light{};
  std::vector<float> ratio;
  std::array<std::vector<float>, 3> channel;

  void clear() {
    stated = weight = 0, light = {};
    ratio.clear();
    for (auto& c : channel) c.clear();
  }
  void add(float w, float variance, Rgb value, const Difference& d) {
    stated += w * variance, weight += w, light += value * w;
    if (d.luminance_ratio < 0) return;
    ratio.push_back(d.luminance_ratio);
    for (int c = 0; c < 3; ++c) channel[size_t(c)].push_back(d.ratio[c]);
  }
};

struct Level {
  float variance = 0;
  Rgb per_channel{1, 1, 1};
};

Level level_of(const Window& window) {
  const float stated = window.stated / window.weight;
  if (window.ratio.size() >= kMinDifferences) {
    const float shown = median(window.ratio);
    if (shown > 0)
      return {stated * std::min(1.0f, shown / kMedianSquare),
              Rgb{median(window.channel[0]), median(window.channel[1]), median(window.channel[2])} /
                  shown};
  }
  // Noise that is as large a part of each channel.
  const float l = luminance(window.light);
  return {stated, l > 0 ? (window.light / l) * (window.light / l) : Rgb{1, 1, 1}};
}

}  // namespace

Result<NoiseLevel> noise_level(const Neighbourhood& n, std::span<const Rgb> values,
                               std::span<const float> variance, Team* team, Progress& progress) {
  std::vector<Difference> difference(values.size());
  const auto differ = [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i)
      if (n.place[i].spacing > 0)
        difference[i] = mixed_difference(n, uint32_t(i), values, variance);
  };
  LUXEL_TRY_STATUS(
      share_ranges(team, values.size(), kBlockTexels, progress, differ, std::span(difference)));
  NoiseLevel level;
  level.variance.assign(values.size(), 0.0f);
  level.per_channel.assign(values.size(), {1, 1, 1});
  const auto find = [&](size_t begin, size_t end) {
    Window window;
    for (size_t i = begin; i < end; ++i) {
      if (n.place[i].spacing <= 0) continue;
      window.clear();
      for_neighbours(n, uint32_t(i), kWindow, [&](uint32_t j, const Neighbour& at) {
        window.add(at.weight, variance[j], values[j], difference[j]);
      });
      if (!(window.stated > 0)) continue;
      const Level own = level_of(window);
      level.variance[i] = own.variance, level.per_channel[i] = own.per_channel;
    }
    progress.advance((end - begin) * kNoiseLevelUnits);
  };
  LUXEL_TRY_STATUS(share_ranges(team, values.size(), kBlockTexels, progress, find,
                                std::span(level.variance), std::span(level.per_channel)));
  return level;
}

}  // namespace luxel::post
