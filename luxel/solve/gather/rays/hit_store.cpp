#include "luxel/solve/gather/rays/hit_store.h"

#include <algorithm>

#include "luxel/base/random.h"

namespace luxel::gather {
namespace {

constexpr float kRedSteps = 15, kGreenSteps = 15, kBlueSteps = 7;

/// The step below or above, such that the mean is the value.
uint32_t step_of(float value, float steps, float chance) {
  return uint32_t(std::min(std::clamp(value, 0.0f, 1.0f) * steps + chance, steps));
}

}  // namespace

uint32_t pack_tint(Rgb color, uint64_t seed) {
  RandomStream random{seed};
  const uint32_t red = step_of(color.x, kRedSteps, random.next());
  const uint32_t green = step_of(color.y, kGreenSteps, random.next());
  return red << 7 | green << 3 | step_of(color.z, kBlueSteps, random.next());
}

Rgb unpack_tint(uint32_t tint) {
  return {float(tint >> 7) / kRedSteps, float(tint >> 3 & 15) / kGreenSteps,
          float(tint & 7) / kBlueSteps};
}

}  // namespace luxel::gather
