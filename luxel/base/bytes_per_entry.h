// Bytes of one entry of some arrays of a struct, for forecasts of memory.
#pragma once

#include <cstdint>

namespace luxel {

/// The sum of the arrays' entry sizes [bytes]. In a struct of arrays, with one entry per element in
/// each, these are the bytes per element: bytes_per_entry(&Elements::position, &Elements::normal).
template <class Struct, class... Array>
constexpr uint64_t bytes_per_entry(Array Struct::*...) {
  return (uint64_t(sizeof(typename Array::value_type)) + ...);
}

}  // namespace luxel
