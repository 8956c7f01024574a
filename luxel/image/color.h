// The sRGB transfer function. [IEC 61966-2-1]
#pragma once

#include <cmath>

namespace luxel::image {

/// Display value in [0, 1] to linear light.
inline float linear_from_srgb(float v) {
  return v <= 0.04045f ? v / 12.92f : std::pow((v + 0.055f) / 1.055f, 2.4f);
}
/// Linear light to display value; inputs outside [0, 1] are not clamped.
inline float srgb_from_linear(float v) {
  return v <= 0.0031308f ? v * 12.92f : 1.055f * std::pow(v, 1.0f / 2.4f) - 0.055f;
}

}  // namespace luxel::image
