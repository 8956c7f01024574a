#include "luxel/solve/gather/budget/adaptive.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "luxel/atlas/neighbours.h"
#include "luxel/base/check.h"
#include "luxel/base/parallel.h"
#include "luxel/solve/gather/budget/error_p95.h"

namespace luxel::gather {
namespace {

/// Neighbours up to so many texels away: 5 x 5, which bring 25 squared differences of halves
/// together.
constexpr int kReach = 2;
/// So many elements' worth of the chart's ratio is added to that of the neighbours, who may be few.
constexpr double kPriorElements = 8;
constexpr float kDarkest = 0.1f;
constexpr size_t kTexelsForForecast = 20000;
/// Levels of direct light: 4^4 times the shadow rays, 4^2 times the points, each of which looks at
/// the lights with rays of its own.
constexpr int kFinestLevel = 4, kFinestAverage = 2;

struct Sums {
  double variance = 0, split = 0;
  uint32_t count = 0;

  void add(const VariancePair& v, size_t i) {
    variance += double(v.independent[i]), split += double(v.split[i]);
    ++count;
  }
  double ratio() const { return variance > 0 ? split / variance : 1; }
};

/// Per element: read for 25 neighbours of each. If `among` names some, all others are of one more
/// chart.
std::vector<uint32_t> charts_of(const atlas::Atlas& atlas, const atlas::TexelMap& map,
                                std::span<const uint32_t> among) {
  const auto chart_at = [&](size_t i) { return atlas.chart[map.texels[i].triangle_number]; };
  std::vector<uint32_t> out(map.texels.size(), uint32_t(atlas.chart_count));
  for (const uint32_t i : among) out[i] = chart_at(i);
  if (!among.empty()) return out;
  for (size_t i = 0; i < out.size(); ++i) out[i] = chart_at(i);
  return out;
}

/// Those of the same chart, itself included.
Sums sums_around(const atlas::TexelMap& map, std::span<const uint32_t> chart,
                 const VariancePair& pair, size_t i) {
  Sums sums;
  for_neighbours(map, i, kReach, [&](uint32_t j) {
    if (chart[j] == chart[i]) sums.add(pair, j);
  });
  return sums;
}

}  // namespace

std::vector<float> pooled_variances(const atlas::Atlas& atlas, const atlas::TexelMap& map,
                                    VariancePair variance, std::span<const uint32_t> among) {
  LUXEL_CHECK(variance.independent.size() == map.texels.size());
  LUXEL_CHECK(variance.split.size() == map.texels.size());
  const std::vector<uint32_t> chart = charts_of(atlas, map, among);
  std::vector<Sums> charts(size_t(atlas.chart_count) + 1);
  for (size_t i = 0; i < chart.size(); ++i) charts[chart[i]].add(variance, i);
  std::vector<float> out(map.texels.size());
  parallel_for(out.size(), 1024, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const Sums near = sums_around(map, chart, variance, i);
      const double mean = near.variance / double(near.count);
      const double prior = kPriorElements * mean;
      const double ratio =
          mean > 0 ? (near.split + prior * charts[chart[i]].ratio()) / (near.variance + prior) : 0;
      // A path that is rare and bright may have been met by the neighbours only.
      out[i] = float(std::max(double(variance.independent[i]), mean) * ratio);
    }
  });
  return out;
}

float darkest_light(std::span<const Rgb> irradiance) {
  double mean = 0;
  for (const Rgb& e : irradiance) mean += double(luminance(e)) / double(irradiance.size());
  return kDarkest * float(mean);
}

std::vector<float> relative_errors(std::span<const float> variance, std::span<const Rgb> irradiance,
                                   const TracedHits& hits) {
  const float darkest = darkest_light(irradiance);
  std::vector<float> out(irradiance.size());
  if (!(darkest > 0)) return out;
  for (size_t i = 0; i < out.size(); ++i)
    if (!is_hidden(hits, i))
      out[i] = std::sqrt(variance[i]) / std::max(luminance(irradiance[i]), darkest);
  return out;
}

std::vector<uint16_t> next_samples(std::span<const float> errors, float max_error, int max_samples,
                                   std::span<const uint16_t> samples) {
  LUXEL_CHECK(max_error >= 0 && errors.size() == samples.size());
  std::vector<uint16_t> out(samples.begin(), samples.end());
  for (size_t i = 0; i < out.size(); ++i) {
    if (errors[i] <= max_error) continue;
    const bool far = std::pow(max_error / errors[i], 1 / kDecay) < 0.25f;
    const int wanted = int(out[i]) * (far ? 4 : 2);
    const int affordable = wanted <= max_samples ? wanted : int(out[i]) * 2;
    if (affordable <= max_samples) out[i] = uint16_t(affordable);
  }
  return out;
}

uint64_t sum_of(std::span<const uint16_t> samples) {
  return std::accumulate(samples.begin(), samples.end(), uint64_t(0));
}

std::vector<uint64_t> rounds_to_come(std::span<const float> all, std::span<const float> gathered,
                                     float max_error, int max_samples,
                                     std::span<const uint16_t> samples) {
  const float each = error_of_part(max_error);
  // Some texels stand for all: it is an estimate.
  const size_t step = std::max<size_t>(1, all.size() / kTexelsForForecast);
  std::vector<float> now, sum, rest;
  std::vector<uint16_t> n;
  for (size_t i = 0; i < all.size(); i += step) {
    const float of_direct = std::sqrt(std::max(0.0f, all[i] * all[i] - gathered[i] * gathered[i]));
    now.push_back(gathered[i]), rest.push_back(std::min(of_direct, each)), n.push_back(samples[i]);
  }
  std::vector<uint64_t> rounds;
  for (;;) {
    sum.clear();
    for (size_t i = 0; i < now.size(); ++i) sum.push_back(std::hypot(now[i], rest[i]));
    if (error_p95(sum) <= max_error) return rounds;
    const std::vector<uint16_t> next = next_samples(now, each, max_samples, n);
    const uint64_t added = sum_of(next) - sum_of(n);
    if (added == 0) return rounds;
    rounds.push_back(step * added);
    for (size_t i = 0; i < now.size(); ++i)
      now[i] *= std::pow(float(n[i]) / float(next[i]), kDecay);
    n = next;
  }
}

void keep_affordable(std::span<const float> errors, uint64_t affordable,
                     std::span<const uint16_t> samples, std::vector<uint16_t>& target) {
  uint64_t added = sum_of(target) - sum_of(samples);
  if (added <= affordable) return;
  std::vector<uint32_t> which;
  for (uint32_t i = 0; i < target.size(); ++i)
    if (target[i] > samples[i]) which.push_back(i);
  const auto gain = [&](uint32_t i) { return errors[i] * errors[i] / float(samples[i]); };
  std::ranges::sort(which, [&](uint32_t a, uint32_t b) {
    const float x = gain(a), y = gain(b);
    return x != y ? x < y : a < b;
  });
  for (const uint32_t i : which) {
    if (added <= affordable) return;
    added -= uint64_t(target[i] - samples[i]);
    target[i] = samples[i];
  }
}

float affordable_error(std::span<const float> errors, float at_least, double rays,
                       const light::SupersampleParams& params, const light::DirectLevels& levels) {
  // The shadow rays of a texel that becomes one level finer. Each of several lights is counted
  // once.
  const auto cost = [&](size_t i) {
    const int factor = 1 << (2 * (int(levels.level[i]) + 1)), samples = params.direct.samples;
    if (!can_be_finer(levels, i)) return 0;
    return levels.averaged[i] ? factor * params.points * std::max(samples / 8, 8)
                              : factor * samples;
  };
  std::vector<uint32_t> which;
  for (uint32_t i = 0; i < errors.size(); ++i)
    if (errors[i] > at_least && cost(i) > 0) which.push_back(i);
  std::ranges::sort(which, [&](uint32_t a, uint32_t b) { return errors[a] > errors[b]; });
  double sum = 0;
  for (const uint32_t i : which) {
    sum += double(cost(i));
    if (sum > rays) return errors[i];
  }
  return at_least;
}

std::vector<uint8_t> elements_above(std::span<const float> errors, float max_error) {
  std::vector<uint8_t> out(errors.size());
  for (size_t i = 0; i < out.size(); ++i) out[i] = errors[i] > max_error;
  return out;
}

bool can_be_finer(const light::DirectLevels& levels, size_t element) {
  return levels.level[element] < (levels.averaged[element] ? kFinestAverage : kFinestLevel);
}

Status look_at_level(const light::TexelScene& in, const ByLook& which, int level,
                     const light::SupersampleParams& params, light::DirectLight& direct,
                     Progress& progress) {
  const int factor = 1 << (2 * level);
  if (!which.averaged.empty()) {
    light::SupersampleParams finer = params;
    finer.points *= factor;
    LUXEL_TRY(const light::Supersampled points,
              average_texels(in, which.averaged, finer, direct, progress));
    direct.rays += points.rays;
  }
  if (which.single.empty()) return {};
  light::DirectParams finer = params.direct;
  finer.samples *= factor;
  return direct_light_again(light::lit_elements(in), which.single, finer, direct, progress);
}

Result<size_t> refine_direct(const light::TexelScene& in, std::span<const uint8_t> chosen,
                             const light::SupersampleParams& params, light::DirectLevels& levels,
                             light::DirectLight& direct, Progress& progress) {
  LUXEL_CHECK(levels.level.size() == chosen.size() && levels.averaged.size() == chosen.size());
  size_t count = 0;
  // From the finest level down: what rises by one level is not met again.
  for (int level = kFinestLevel - 1; level >= 0; --level) {
    ByLook which;
    for (uint32_t i = 0; i < chosen.size(); ++i) {
      if (!chosen[i] || levels.level[i] != level || !can_be_finer(levels, i)) continue;
      (levels.averaged[i] ? which.averaged : which.single).push_back(i);
    }
    LUXEL_TRY_STATUS(look_at_level(in, which, level + 1, params, direct, progress));
    for (const auto& risen : {which.averaged, which.single})
      for (const uint32_t i : risen) ++levels.level[i];
    count += which.single.size() + which.averaged.size();
  }
  return count;
}

}  // namespace luxel::gather
