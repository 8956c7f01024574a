#include "luxel/post/outliers.h"

#include <algorithm>
#include <array>
#include <vector>

#include "luxel/base/parallel.h"

namespace luxel::post {
namespace {

/// Fewer neighbours say nothing about what light there is.
constexpr size_t kFewestAround = 6;
/// A whole neighbourhood is 20 texels, that of a texel at a straight border 12.
constexpr size_t kMostAtBorder = 15;

/// What the texels around one show.
struct Surrounding {
  size_t count = 0, noisy = 0;        ///< texels, and those that state a variance
  std::array<float, 3> brightest{};  ///< luminances in descending order

  void add(float light, bool is_noisy) {
    ++count, noisy += is_noisy;
    if (light > brightest[0])
      brightest = {light, brightest[0], brightest[1]};
    else if (light > brightest[1])
      brightest = {brightest[0], light, brightest[1]};
    else
      brightest[2] = std::max(brightest[2], light);
  }
  /// The luminance that a texel is judged by; infinite where its neighbours are too few. At a
  /// border half of a line's or a spot's texels are missing.
  float usual() const {
    if (count < kFewestAround) return INFINITY;
    return count < kMostAtBorder ? brightest[1] : brightest[2];
  }
};

Surrounding surrounding(const Neighbourhood& n, std::span<const float> variance,
                        std::span<const Rgb> values, uint32_t i) {
  Surrounding around;
  // On a strip of one texel's width neighbours are few: more of them lie farther away.
  for (const float radius : {kFireflyRadius, kFireflyRadiusOfStrips}) {
    around = {};
    for_neighbours(n, i, radius, [&](uint32_t j, const Neighbour&) {
      if (j != i) around.add(luminance(values[j]), variance[j] > 0);
    });
    if (around.count >= kFewestAround) break;
  }
  return around;
}

/// The largest variance that explains a texel of indirect light. A single square of a difference of
/// halves may be small by chance; its mean over many is not.
float stated_around(const Neighbourhood& n, std::span<const float> variance, uint32_t i) {
  float sum = 0, count = 0;
  for_neighbours(n, i, kShareRadius,
                 [&](uint32_t j, const Neighbour&) { sum += variance[j], ++count; });
  return std::max(variance[i], sum / count);
}

/// The luminance to which a firefly is lowered; infinite for what is none.
float lowered(const Neighbourhood& n, const Outliers& part, std::span<const Rgb> values,
              uint32_t i) {
  const Surrounding around = surrounding(n, part.variance, values, i);
  const float light = luminance(values[i]), usual = around.usual(), above = light - usual;
  if (!(above > 0)) return INFINITY;
  if (!part.is_direct && light > kFirefly * usual) return usual;
  const auto within = [&](float deviations, float variance) {
    return above * above <= deviations * deviations * variance;
  };
  if (within(kStandsOut, part.noise.variance[i])) return INFINITY;
  const bool is_firefly = part.is_direct
                              ? 2 * around.noisy >= around.count && within(kExplainedDirect, part.variance[i])
                              : within(kExplained, stated_around(n, part.variance, i));
  return is_firefly ? usual : INFINITY;
}

}  // namespace

size_t share_out_fireflies(const Neighbourhood& n, const Outliers& part, std::span<Rgb> values) {
  const auto is_noisy = [&](size_t i) { return part.variance[i] > 0 && n.place[i].spacing > 0; };
  std::vector<float> lowered_to(values.size(), INFINITY);
  parallel_for(values.size(), kBlockTexels, [&](size_t begin, size_t end) {
    for (uint32_t i = uint32_t(begin); i < end; ++i) {
      if (!is_noisy(i)) continue;
      lowered_to[i] = lowered(n, part, values, i);
    }
  });
  // Few and one after the other: sums have one order for any number of threads.
  std::vector<Rgb> added(values.size());
  size_t count = 0;
  for (uint32_t i = 0; i < values.size(); ++i) {
    if (lowered_to[i] == INFINITY) continue;
    std::vector<uint32_t> takers;
    for_neighbours(n, i, kShareRadius, [&](uint32_t j, const Neighbour&) {
      if (is_noisy(j)) takers.push_back(j);
    });
    const Rgb kept = values[i] * (lowered_to[i] / luminance(values[i]));
    for (const uint32_t j : takers) added[j] += (values[i] - kept) / float(takers.size());
    values[i] = kept;
    ++count;
  }
  for (size_t i = 0; i < values.size(); ++i) values[i] += added[i];
  return count;
}

}  // namespace luxel::post
