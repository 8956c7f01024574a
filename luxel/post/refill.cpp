#include "luxel/post/refill.h"

#include <array>
#include <vector>

#include "luxel/base/check.h"

namespace luxel::post {
namespace {

/// The eight around a texel, the nearest first.
constexpr std::array<std::array<int, 2>, 8> kAround{
    {{-1, 0}, {1, 0}, {0, -1}, {0, 1}, {-1, -1}, {1, -1}, {-1, 1}, {1, 1}}};

/// A texel and the visible neighbours that it takes the mean of.
struct Filled {
  uint32_t texel = 0;
  std::array<uint32_t, 8> from{};
  size_t count = 0;
};

/// The visible neighbours in the same chart that lie on the side of the nearest one.
Filled neighbours_of(const atlas::Atlas& atlas, const atlas::TexelMap& map,
                     std::span<const uint8_t> hidden, const Parted& parted, uint32_t texel) {
  const atlas::Texel& t = map.texels[texel];
  const int side = map.resolution;
  Filled out{.texel = texel};
  for (const auto& [dx, dy] : kAround) {
    const int x = int(t.x) + dx, y = int(t.y) + dy;
    if (x < 0 || y < 0 || x >= side || y >= side) continue;
    const uint32_t other = map.texel_at[size_t(y) * size_t(side) + size_t(x)];
    if (other == atlas::kNone || hidden[other]) continue;
    if (atlas.chart[map.texels[other].triangle_number] != atlas.chart[t.triangle_number]) continue;
    if (out.count > 0 && parted && parted(out.from[0], other)) continue;
    out.from[out.count++] = other;
  }
  return out;
}

/// None of the texels that are read is filled in the same ring: those are visible already.
void take_means(std::span<const Filled> ring, std::span<Rgb> values) {
  for (const Filled& filled : ring) {
    Rgb sum{};
    for (size_t k = 0; k < filled.count; ++k) sum += values[filled.from[k]];
    values[filled.texel] = sum / float(filled.count);
  }
}

}  // namespace

std::vector<uint32_t> refill_hidden(const atlas::Atlas& atlas, const atlas::TexelMap& map,
                                    std::span<const uint8_t> hidden, int rings,
                                    const Parted& parted, std::span<Rgb> values) {
  return refill_hidden(atlas, map, hidden, rings, parted, std::span(&values, 1));
}

std::vector<uint32_t> refill_hidden(const atlas::Atlas& atlas, const atlas::TexelMap& map,
                                    std::span<const uint8_t> hidden, int rings,
                                    const Parted& parted, std::span<const std::span<Rgb>> arrays) {
  LUXEL_CHECK(hidden.size() == map.texels.size());
  for (const std::span<Rgb> values : arrays) LUXEL_CHECK(values.size() == map.texels.size());
  std::vector<uint8_t> now(hidden.begin(), hidden.end());
  std::vector<uint32_t> all;
  for (int k = 0; k < rings; ++k) {
    std::vector<Filled> ring;
    for (uint32_t i = 0; i < now.size(); ++i) {
      if (!now[i]) continue;
      const Filled filled = neighbours_of(atlas, map, now, parted, i);
      if (filled.count > 0) ring.push_back(filled);
    }
    for (const std::span<Rgb> values : arrays) take_means(ring, values);
    for (const Filled& filled : ring) {
      now[filled.texel] = 0;
      all.push_back(filled.texel);
    }
  }
  return all;
}

}  // namespace luxel::post
