#include "post/refill.h"

#include <array>
#include <utility>
#include <vector>

#include "base/check.h"

namespace luxel::post {
namespace {

/// The eight around a texel, the nearest first.
constexpr std::array<std::array<int, 2>, 8> kAround{
    {{-1, 0}, {1, 0}, {0, -1}, {0, 1}, {-1, -1}, {1, -1}, {-1, 1}, {1, 1}}};

/// Mean of the visible neighbours in the same chart; false when there is none.
bool neighbour_mean(const atlas::Atlas& atlas, const atlas::TexelMap& map,
                    std::span<const uint8_t> hidden, const Parted& parted,
                    std::span<const Rgb> values, uint32_t texel, Rgb& mean) {
  const atlas::Texel& t = map.texels[texel];
  const int side = map.resolution;
  Rgb sum{};
  int count = 0;
  uint32_t nearest = atlas::kNone;
  for (const auto& [dx, dy] : kAround) {
    const int x = int(t.x) + dx, y = int(t.y) + dy;
    if (x < 0 || y < 0 || x >= side || y >= side) continue;
    const uint32_t other = map.texel_at[size_t(y) * size_t(side) + size_t(x)];
    if (other == atlas::kNone || hidden[other]) continue;
    if (atlas.chart[map.texels[other].triangle_number] != atlas.chart[t.triangle_number]) continue;
    if (nearest == atlas::kNone)
      nearest = other;
    else if (parted && parted(nearest, other))
      continue;
    sum += values[other];
    ++count;
  }
  if (count > 0) mean = sum / float(count);
  return count > 0;
}

}  // namespace

std::vector<uint32_t> refill_hidden(const atlas::Atlas& atlas, const atlas::TexelMap& map,
                                    std::span<const uint8_t> hidden, int rings,
                                    const Parted& parted, std::span<Rgb> values) {
  LUXEL_CHECK(hidden.size() == map.texels.size() && values.size() == map.texels.size());
  std::vector<uint8_t> now(hidden.begin(), hidden.end());
  std::vector<uint32_t> all;
  for (int ring = 0; ring < rings; ++ring) {
    std::vector<std::pair<uint32_t, Rgb>> filled;
    for (uint32_t i = 0; i < now.size(); ++i) {
      Rgb mean;
      if (now[i] && neighbour_mean(atlas, map, now, parted, values, i, mean))
        filled.push_back({i, mean});
    }
    for (const auto& [i, mean] : filled) {
      values[i] = mean, now[i] = 0;
      all.push_back(i);
    }
  }
  return all;
}

}  // namespace luxel::post
