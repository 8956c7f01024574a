// Vectors of which nothing is left to read.
#pragma once

#include <vector>

namespace luxel {
inline namespace base {

/// Empties a vector and gives its memory back. `v = {}` does not: it assigns an empty list, and the
/// capacity stays.
template <class T, class Allocator>
void free_memory(std::vector<T, Allocator>& v) {
  std::vector<T, Allocator>().swap(v);
}

}  // namespace base
}  // namespace luxel
