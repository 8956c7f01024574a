#include "luxel/scene/position_numbers.h"

#include <algorithm>
#include <tuple>

namespace luxel::scene {

std::vector<uint32_t> position_numbers(std::span<const Vec3> positions) {
  const auto key = [&](uint32_t i) {
    const Vec3 p = positions[i];
    return std::tuple(p.x, p.y, p.z);
  };
  std::vector<uint32_t> order(positions.size());
  for (uint32_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return key(a) < key(b); });
  std::vector<uint32_t> number(positions.size());
  uint32_t next = 0;
  for (size_t i = 0; i < order.size(); ++i) {
    if (i > 0 && key(order[i - 1]) != key(order[i])) ++next;
    number[order[i]] = next;
  }
  return number;
}

}  // namespace luxel::scene
