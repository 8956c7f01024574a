#include "luxel/view/edit/sky_sun.h"

#include <algorithm>
#include <cmath>

#include "luxel/base/vec_double.h"
#include "luxel/scene/sun_illuminance.h"

namespace luxel::view {
namespace {

constexpr double kSkyDegree = kPiDouble / 180;
/// Rounding of what was the sky's own light.
constexpr float kSameLight = 1e-4f;

double to_hundredths(double degrees) { return std::round(100 * degrees) / 100; }

/// Its air stays, with the sun there.
SkyAsked sky_with_sun(Vec3 towards, const pipeline::SkySetting& before) {
  pipeline::SkySetting out = before;
  const double azimuth = std::atan2(double(towards.x), -double(towards.z)) / kSkyDegree;
  out.azimuth_deg = to_hundredths(azimuth < 0 ? azimuth + 360 : azimuth);
  out.elevation_deg =
      to_hundredths(std::asin(std::clamp(double(towards.y), -1.0, 1.0)) / kSkyDegree);
  out.sun_distance_au = 1;
  return {out, fmt::format("{},{},{}", out.azimuth_deg, out.elevation_deg, out.turbidity)};
}

Rgb sun_illuminance(const pipeline::SkySetting& sky) {
  return scene::sun_illuminance(pipeline::sky_params(sky));
}

bool is_light_of(Rgb light, const pipeline::SkySetting& sky) {
  const Rgb own = sun_illuminance(sky);
  return length(light - own) <= kSameLight * length(own);
}

}  // namespace

LampSet lamp_set(uint32_t lamp, const Lamp& to, const std::optional<SkyAsked>& asked,
                 const EditDesk& desk) {
  LampSet out{lamp, to.light, to.is_on, std::nullopt};
  const auto& sun = desk.read->sun;
  if (!sun || sun->light != lamp) return out;
  const scene::PunctualLight& before = desk.now.lamps[lamp].light;
  out.sky = desk.now.sky;  // the edit says all, even where it changes less
  if (to.light.direction == before.direction && !asked) return out;
  const pipeline::SkySetting& sky = desk.now.sky ? desk.now.sky->setting : sun->sky;
  const SkyAsked next = asked ? *asked : sky_with_sun(-normalize(to.light.direction), sky);
  const Vec3 towards = pipeline::sky_params(next.setting).towards_sun;
  out.light.direction = -to_float(normalize(to_double(towards)));  // as make_sky() has it
  if (to.light.intensity == before.intensity && is_light_of(before.intensity, sky))
    out.light.intensity = sun_illuminance(next.setting);
  out.sky = next;
  return out;
}

bool is_of_sky(uint32_t lamp, const ReadScene& read, const SceneNow& now) {
  if (!read.sun || read.sun->light != lamp) return false;
  const Lamp& sun = now.lamps[lamp];
  return sun.is_on && !sun.is_deleted &&
         sun.light.angular_radius_rad == read.scene.lights[lamp].angular_radius_rad &&
         is_light_of(sun.light.intensity, now.sky ? now.sky->setting : read.sun->sky);
}

}  // namespace luxel::view
