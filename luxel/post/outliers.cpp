#include "luxel/post/outliers.h"

#include <algorithm>
#include <array>
#include <vector>

#include "luxel/base/share_out.h"

namespace luxel::post {
namespace {

/// Fewer neighbours say nothing about what light there is.
constexpr size_t kFewestAround = 6;
/// A whole neighbourhood is 20 texels, that of a texel at a straight border 12.
constexpr size_t kMostAtBorder = 15;

/// The brightest of some texels.
struct Brightest {
  size_t count = 0;
  std::array<float, 3> luminances{};  ///< in descending order

  void add(float light) {
    ++count;
    std::array<float, 3>& l = luminances;
    if (light > l[0])
      l = {light, l[0], l[1]};
    else if (light > l[1])
      l = {l[0], light, l[1]};
    else
      l[2] = std::max(l[2], light);
  }
};

/// The luminance of the neighbour that a texel is judged by; infinite where they are too few.
float usual_around(const Neighbourhood& n, std::span<const Rgb> values, uint32_t i) {
  // On a strip of one texel's width neighbours are few: more of them lie farther away.
  for (const float radius : {kFireflyRadius, kFireflyRadiusOfStrips}) {
    Brightest around;
    for_neighbours(n, i, radius, [&](uint32_t j, const Neighbour&) {
      if (j != i) around.add(luminance(values[j]));
    });
    if (around.count < kFewestAround) continue;
    // At a border half of a line's or a spot's texels are missing.
    return around.luminances[around.count < kMostAtBorder ? 1 : 2];
  }
  return INFINITY;
}

/// The largest variance that explains a texel of indirect light. A single square of a difference of
/// halves may be small by chance; its mean over many is not.
float stated_around(const Neighbourhood& n, std::span<const float> variance, uint32_t i) {
  float sum = 0, count = 0;
  for_neighbours(n, i, kShareRadius,
                 [&](uint32_t j, const Neighbour&) { sum += variance[j], ++count; });
  return std::max(variance[i], sum / count);
}

/// The luminance to which a texel is to be lowered; infinite for what is no firefly.
float lowered(const Neighbourhood& n, const Outliers& part, uint32_t i) {
  const float usual = usual_around(n, part.values, i);
  const float light = luminance(part.values[i]), above = light - usual;
  if (!(above > 0)) return INFINITY;
  if (!part.is_direct && light > kFirefly * usual) return usual;
  const auto within = [&](float deviations, float variance) {
    return above * above <= deviations * deviations * variance;
  };
  if (within(kStandsOut, part.noise.variance[i])) return INFINITY;
  const bool is_firefly = part.is_direct ? within(kExplainedDirect, part.variance[i])
                                         : within(kExplained, stated_around(n, part.variance, i));
  return is_firefly ? usual : INFINITY;
}

/// Halves of rays that all bring the same light differ by rounding alone, by less than this part of
/// it: there is no noise.
constexpr float kRounding = 1e-5f;

bool is_noisy(const Neighbourhood& n, std::span<const float> variance, std::span<const Rgb> values,
              uint32_t i) {
  const float rounding = kRounding * luminance(values[i]);
  return n.place[i].spacing > 0 && variance[i] > rounding * rounding;
}

}  // namespace

Result<std::vector<Firefly>> find_fireflies(const Neighbourhood& n, const Outliers& part,
                                            Team* team, Progress& progress) {
  std::vector<float> lowered_to(part.values.size(), INFINITY);
  const auto look = [&](size_t begin, size_t end) {
    for (uint32_t i = uint32_t(begin); i < end; ++i)
      if (is_noisy(n, part.variance, part.values, i)) lowered_to[i] = lowered(n, part, i);
  };
  LUXEL_TRY_STATUS(
      share_ranges(team, part.values.size(), kBlockTexels, progress, look, std::span(lowered_to)));
  std::vector<Firefly> found;
  for (uint32_t i = 0; i < lowered_to.size(); ++i)
    if (lowered_to[i] < INFINITY) found.push_back({i, lowered_to[i]});
  return found;
}

void share_out(const Neighbourhood& n, std::span<const float> variance,
               std::span<const Firefly> fireflies, std::span<Rgb> values) {
  // Few and one after the other: sums have one order for any number of threads.
  std::vector<Rgb> added(values.size());
  std::vector<uint32_t> takers;
  for (const Firefly& f : fireflies) {
    takers.clear();
    for_neighbours(n, f.texel, kShareRadius, [&](uint32_t j, const Neighbour&) {
      if (is_noisy(n, variance, values, j)) takers.push_back(j);
    });
    Rgb& value = values[f.texel];
    const Rgb kept = value * (f.luminance / luminance(value));
    for (const uint32_t j : takers) added[j] += (value - kept) / float(takers.size());
    value = kept;
  }
  for (size_t i = 0; i < values.size(); ++i) values[i] += added[i];
}

}  // namespace luxel::post
