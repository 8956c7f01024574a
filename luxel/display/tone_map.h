// From radiance to what a screen can show.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "luxel/image/codec.h"
#include "luxel/image/image.h"

namespace luxel::display {

/// The factor that brings a percentile of luminance over pixels with A > 0 (all pixels when there
/// is no alpha, or none of these has light) to 0.6; 1 for a black picture. Where so many pixels are
/// black that the percentile is, the black ones do not count. `percentile` in [0, 100].
float auto_exposure(const image::Image& radiance, double percentile = 90);

/// The factor that a viewer would choose: auto_exposure(), but where much of the picture is far
/// darker than its bright part (a room with the sun on its floor) more, up to 13 times. The mean of
/// log luminance is then shown at 0.15, and highlights go over the shoulder. Pixels that are black
/// beside the bright part have nothing to show and do not count.
float readable_exposure(const image::Image& radiance);

/// The factor of an exposure in photographic stops: 2^stops.
float exposure_of_stops(double stops);

// Curves: exposed linear radiance to linear display values in [0, 1]; negative light is black, and
// no channel gets darker when the exposure grows.

/// Colours whose channels are all at most 0.5 stay as they are. The largest channel of brighter
/// ones goes over a smooth shoulder that never clips, and the others with it, so that hue and
/// saturation stay; what is brighter than 1 moves slowly to white.
Rgb compress(Rgb exposed);

/// Exposed: what pictures show where a scene has nothing behind its surfaces. The curve leaves it
/// as it is.
inline constexpr Rgb kGreyOfNothing{0.2f, 0.2f, 0.2f};

/// c / (k + c) in every channel, k > 0. [Moreno05, section 4.4.2] The paper's k of 0.1 to 0.02 is a
/// k of 1 with log2(1 / k) = 3.3 to 5.6 stops more.
Rgb ratio_curve(Rgb exposed, float k = 1);

/// L (1 + L / white^2) / (1 + L) on luminance L: `white` and what is brighter is 1.
/// [Reinhard02, eq. 4] Hues stay; channels beyond 1 are clipped.
Rgb reinhard_curve(Rgb exposed, float white = 4);

/// (2.51 c^2 + 0.03 c) / (2.43 c^2 + 0.59 c + 0.14) in every channel, clipped at 1: a fit of the
/// filmic curve of ACES. [Narkowicz16]
Rgb filmic_curve(Rgb exposed);

/// Clips every channel to [0, 1].
Rgb clamp_curve(Rgb exposed);

/// The curves above, in the order of kToneMaps.
enum class ToneMap : uint8_t { shoulder, ratio, reinhard, filmic, clamp };

/// Names, as in `luxel render --tone-map`.
struct NamedToneMap {
  std::string_view name;
  ToneMap curve;
};
inline constexpr std::array<NamedToneMap, 5> kToneMaps{{{"shoulder", ToneMap::shoulder},
                                                        {"ratio", ToneMap::ratio},
                                                        {"reinhard", ToneMap::reinhard},
                                                        {"filmic", ToneMap::filmic},
                                                        {"clamp", ToneMap::clamp}}};
/// The curve of a name of kToneMaps; none for another name.
std::optional<ToneMap> find_tone_map(std::string_view name);

/// The curve with its default parameter.
Rgb apply(ToneMap curve, Rgb exposed);

/// exposure * radiance through the curve, as 8-bit sRGB with 3 channels (alpha is dropped: the
/// picture stands for itself).
image::Image8 tone_map(const image::Image& radiance, float exposure,
                       ToneMap curve = ToneMap::shoulder);

}  // namespace luxel::display
