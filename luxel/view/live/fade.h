// Fades from the light that is shown to better known light, without a jump.
#pragma once

#include <cstdint>

namespace luxel::view {

/// The two pictures of DeviceScene::lights, one of which may be fading into the other, and the
/// exposure that goes with them.
struct Fade {
  uint32_t newest = 0;  ///< the picture with the light that was put there last
  float share = 1;      ///< of `newest` in what is shown
  float exposure_before = 1, exposure_newest = 1;
};

/// Duration of a fade [s].
inline constexpr double kFade_s = 1;

/// True: the other picture is not shown, so that light can be put into it.
bool is_free(const Fade& fade);
/// Light was put into the picture that is not `newest`: it is, from now on, and fades in.
Fade faded_to_other(const Fade& fade, float exposure);
/// Light is put into the picture that is `newest`, and nothing else is seen.
Fade at_once(const Fade& fade, float exposure);
/// So many seconds later.
void pass(double seconds, Fade& fade);

/// DeviceScene::second_light.
float second_light(const Fade& fade);
/// Between the two, by equal steps of stops.
float exposure(const Fade& fade);

}  // namespace luxel::view
