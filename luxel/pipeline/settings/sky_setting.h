// A clear sky, by the sun's direction or by time and place.
#pragma once

#include <string_view>

#include "luxel/base/result.h"
#include "luxel/scene/scene.h"
#include "luxel/scene/sky.h"

namespace luxel::pipeline {

struct SkySetting {
  double azimuth_deg = 0;     ///< compass bearing: 0 north = -Z, 90 east = +X
  double elevation_deg = 45;  ///< above the horizon, Y being up
  double turbidity = 2;       ///< 1 to 10
  double sun_distance_au = 1;
};

/// "AZIMUTH_DEG,ELEVATION_DEG[,TURBIDITY]" or "TIME,LATITUDE,LONGITUDE[,TURBIDITY]" with degrees
/// north and east and an ISO 8601 time that says its offset from UTC: 2026-06-21T15:30+02:00 or
/// 2026-06-21T13:30:00Z, years 1900 to 2100.
Result<SkySetting> parse_sky(std::string_view text);

scene::SkyParams sky_params(const SkySetting& setting);

/// A directional light with the sun's disc; `illuminance` is that of a surface that faces it.
scene::PunctualLight sun_light(Rgb illuminance, Vec3 towards);

/// Adds the sky and a directional light for its sun.
void add_sky(const SkySetting& setting, scene::Scene& scene);

}  // namespace luxel::pipeline
