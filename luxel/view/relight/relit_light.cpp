#include "luxel/view/relight/relit_light.h"

#include "luxel/base/clock.h"

namespace luxel::view {

Result<RelitLight> make_relit_light(matrix::RelightData data) {
  MapPlaces places = map_places(data.target);
  image::Image map(places.width, places.height, 4);
  LUXEL_TRY(matrix::Relighter relighter, matrix::Relighter::make(std::move(data), {}));
  return RelitLight{std::move(relighter), std::move(places), std::move(map), {}};
}

void relight(const Lamps& lamps, RelitLight& light, std::span<const Rgb> at_probes) {
  const std::vector<scene::PunctualLight> punctual = shining(lamps);
  const std::vector<Rgb> emission = glowing(lamps);
  light.relighter.update({punctual, emission, lamps.background, at_probes});
  const Clock::time_point start = Clock::now();
  put_light(light.places, light.relighter.latest().indirect_at_points, light.indirect);
  const matrix::Relighter::Seconds seconds = light.relighter.seconds();
  light.took = {1e3 * seconds.direct, 1e3 * seconds.bounces, 1e3 * seconds.places,
                1e3 * seconds_since(start)};
}

}  // namespace luxel::view
