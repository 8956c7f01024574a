// Light of all bounces that follows the lamps, without a window.
#pragma once

#include "luxel/image/image.h"
#include "luxel/solve/matrix/relighter.h"
#include "luxel/view/relight/lamps.h"
#include "luxel/view/relight/relit_map.h"

namespace luxel::view {

/// A relighter of a scene, and the light that the scene has now.
struct RelitLight {
  matrix::Relighter relighter;
  MapPlaces places;
  /// E but for what comes straight from lamps, and that of glowing materials [W/m^2]; 4 channels.
  image::Image indirect;
  /// Times of the last relight() [ms].
  struct Milliseconds {
    double direct = 0, bounces = 0, places = 0, map = 0;
    double total() const { return direct + bounces + places + map; }
  };
  Milliseconds took;
};

/// `data` is lit at texels. Errors: triangles that cannot be traced.
Result<RelitLight> make_relit_light(matrix::RelightData data);

/// E after all bounces of these lamps. `at_probes`: what they make straight at each of the
/// relighter's data().probe [W/m^2]; empty: shadow rays are traced.
void relight(const Lamps& lamps, RelitLight& light, std::span<const Rgb> at_probes = {});

}  // namespace luxel::view
