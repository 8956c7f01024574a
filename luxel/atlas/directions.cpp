#include "luxel/atlas/directions.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "luxel/base/parallel.h"

namespace luxel::atlas {
namespace {

constexpr int kDirections = 8;      ///< in a quarter turn; 16 gain nothing that can be measured
constexpr double kBlobFill = 0.85;  ///< of its rectangle; above, a chart is as good as a rectangle
constexpr double kSmall = 4e-4;     ///< a chart's shorter side squared, as a share of all area
constexpr size_t kFewBlobs = 32, kMostBlobs = 512;

double area_of(const FlatChart& chart) {
  double area = 0;
  for (const auto& t : chart.corners) area += 0.5 * std::abs(cross(t[1] - t[0], t[2] - t[0]));
  return area;
}

/// The chart turned left, its rectangle at the origin again.
FlatChart turned_chart(const FlatChart& chart, double angle) {
  FlatChart t = chart;
  const DVec2 d{std::cos(angle), std::sin(angle)};
  DVec2 low{INFINITY, INFINITY}, high{-INFINITY, -INFINITY};
  for (auto& corners : t.corners)
    for (DVec2& p : corners) {
      p = {dot(d, p), cross(d, p)};
      low = {std::min(low.x, p.x), std::min(low.y, p.y)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y)};
    }
  for (auto& corners : t.corners)
    for (DVec2& p : corners) p = p - low;
  t.size = high - low;
  return t;
}

/// The blobs that are worth turning, the largest first.
std::vector<uint32_t> blobs_to_turn(const std::vector<FlatChart>& charts) {
  const double total = flat_area(charts);
  std::vector<double> area(charts.size());
  std::vector<uint32_t> blobs;
  double blob_area = 0;
  for (uint32_t c = 0; c < charts.size(); ++c) {
    const DVec2 size = charts[c].size;
    const double shortest = std::min(size.x, size.y);
    area[c] = area_of(charts[c]);
    if (area[c] >= kBlobFill * size.x * size.y || shortest * shortest < kSmall * total) continue;
    blobs.push_back(c);
    blob_area += area[c];
  }
  if (blobs.size() > kFewBlobs && blob_area < 0.5 * total) return {};
  std::stable_sort(blobs.begin(), blobs.end(),
                   [&](uint32_t a, uint32_t b) { return area[a] > area[b]; });
  blobs.resize(std::min(blobs.size(), kMostBlobs));
  return blobs;
}

}  // namespace

double flat_area(const std::vector<FlatChart>& charts) {
  double area = 0;
  for (const FlatChart& c : charts) area += area_of(c);
  return area;
}

std::vector<TurnedChart> directions_of(const std::vector<FlatChart>& charts) {
  std::vector<TurnedChart> turned(charts.size());
  for (size_t c = 0; c < charts.size(); ++c) turned[c].push_back(charts[c]);
  const std::vector<uint32_t> blobs = blobs_to_turn(charts);
  parallel_for(blobs.size(), 1, [&](size_t b, size_t) {
    const uint32_t c = blobs[b];
    for (int k = 1; k < kDirections; ++k)
      turned[c].push_back(turned_chart(charts[c], k * std::numbers::pi / 2 / kDirections));
  });
  return turned;
}

}  // namespace luxel::atlas
