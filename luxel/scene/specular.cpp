#include "luxel/scene/specular.h"

#include <algorithm>
#include <cmath>

namespace luxel::scene {
namespace {

constexpr float kLeast = 1, kMost = 10000;

}  // namespace

float sharpness_of(float roughness) {
  const float alpha2 = roughness * roughness * roughness * roughness;
  const float n = (2 / std::max(alpha2, 1e-12f) - 2) / 4;
  return std::clamp(n, kLeast, kMost);
}

float roughness_of(float sharpness) {
  const float n = std::clamp(sharpness, 0.0f, kMost);
  return std::pow(2 / (4 * n + 2), 0.25f);
}

Rgb specular_of(Rgb f0, float sharpness) {
  return min(max(f0 * ((sharpness + 1) / 2), Rgb{}), Rgb{1, 1, 1});
}

Rgb f0_of(Rgb specular, float sharpness) { return specular * (2 / (sharpness + 1)); }

}  // namespace luxel::scene
