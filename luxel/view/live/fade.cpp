#include "luxel/view/live/fade.h"

#include <algorithm>
#include <cmath>

#include "luxel/base/check.h"

namespace luxel::view {

bool is_free(const Fade& fade) { return fade.share >= 1; }

Fade faded_to_other(const Fade& fade, float exposure) {
  LUXEL_CHECK(is_free(fade));
  return {1 - fade.newest, 0, fade.exposure_newest, exposure};
}

Fade at_once(const Fade& fade, float exposure) { return {fade.newest, 1, exposure, exposure}; }

void pass(double seconds, Fade& fade) {
  fade.share = float(std::min(1.0, double(fade.share) + seconds / kFade_s));
}

float second_light(const Fade& fade) { return fade.newest == 1 ? fade.share : 1 - fade.share; }

float exposure(const Fade& fade) {
  if (is_free(fade)) return fade.exposure_newest;
  return fade.exposure_before * std::pow(fade.exposure_newest / fade.exposure_before, fade.share);
}

}  // namespace luxel::view
