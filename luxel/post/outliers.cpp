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

/// The luminance of the neighbour that a texel is judged by; infinite where they are too few.
float usual_around(const Neighbourhood& n, std::span<const Rgb> values, uint32_t i) {
  std::array<float, 3> brightest{};  // in descending order
  size_t count = 0;
  for_neighbours(n, i, kFireflyRadius, [&](uint32_t j, const Neighbour&) {
    if (j == i) return;
    ++count;
    const float l = luminance(values[j]);
    if (l > brightest[0])
      brightest = {l, brightest[0], brightest[1]};
    else if (l > brightest[1])
      brightest = {brightest[0], l, brightest[1]};
    else
      brightest[2] = std::max(brightest[2], l);
  });
  if (count < kFewestAround) return INFINITY;
  // At a border half of a line's or a spot's texels are missing.
  return count < kMostAtBorder ? brightest[1] : brightest[2];
}

}  // namespace

size_t share_out_fireflies(const Neighbourhood& n, std::span<const float> variance,
                           std::span<Rgb> values) {
  const auto is_noisy = [&](size_t i) { return variance[i] > 0 && n.place[i].spacing > 0; };
  std::vector<float> usual(values.size(), INFINITY);
  parallel_for(values.size(), kBlockTexels, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i)
      if (is_noisy(i)) usual[i] = usual_around(n, values, uint32_t(i));
  });
  // Few and one after the other: sums have one order for any number of threads.
  std::vector<Rgb> added(values.size());
  size_t lowered = 0;
  for (uint32_t i = 0; i < values.size(); ++i) {
    const float l = luminance(values[i]);
    if (!(l > kFirefly * usual[i])) continue;
    std::vector<uint32_t> takers;
    for_neighbours(n, i, kShareRadius, [&](uint32_t j, const Neighbour&) {
      if (is_noisy(j)) takers.push_back(j);
    });
    const Rgb kept = values[i] * (usual[i] / l);
    for (const uint32_t j : takers) added[j] += (values[i] - kept) / float(takers.size());
    values[i] = kept;
    ++lowered;
  }
  for (size_t i = 0; i < values.size(); ++i) values[i] += added[i];
  return lowered;
}

}  // namespace luxel::post
