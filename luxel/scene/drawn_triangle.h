// A drawn triangle's number, taken apart.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

namespace luxel::scene {

struct DrawnTriangle {
  uint32_t instance = 0, triangle = 0;
};

/// The triangle of a `number` that counts as in first_triangles(), whose result is `first`.
inline DrawnTriangle drawn_triangle(std::span<const uint32_t> first, uint32_t number) {
  const auto after = std::upper_bound(first.begin(), first.end(), number);
  const auto instance = uint32_t(after - first.begin() - 1);
  return {instance, number - first[instance]};
}

}  // namespace luxel::scene
