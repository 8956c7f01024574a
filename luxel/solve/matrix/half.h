// Half-precision numbers, IEEE 754 binary16, as stored: two bytes of what memory has to deliver.
#pragma once

#include <cstdint>

namespace luxel::matrix {

inline constexpr float kLargestHalf = 65504;

/// Rounds to nearest, ties to even; |x| <= kLargestHalf.
uint16_t half_from_float(float x);

/// Exactly; the half is finite.
float float_from_half(uint16_t half);

}  // namespace luxel::matrix
