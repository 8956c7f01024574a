// Disjoint sets as a forest: parent[i] of each element, which is i itself at a root.
#pragma once

#include <cstdint>
#include <vector>

namespace luxel {
inline namespace base {

/// The root of the set of i. Halves the path on its way [Tarjan84].
inline uint32_t root_of(std::vector<uint32_t>& parent, uint32_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

}  // namespace base
}  // namespace luxel
