// How many bytes one entry of some arrays of a struct takes, for forecasts of memory.
#pragma once

#include <cstdint>
#include <vector>

namespace luxel {

/// The sum of the arrays' entry sizes [bytes]. In a struct of arrays, with one entry per element in
/// each, these are the bytes per element: bytes_per_entry(&Elements::position, &Elements::normal).
template <class Struct, class... Entry>
constexpr uint64_t bytes_per_entry(std::vector<Entry> Struct::*...) {
  return (uint64_t(sizeof(Entry)) + ...);
}

}  // namespace luxel
