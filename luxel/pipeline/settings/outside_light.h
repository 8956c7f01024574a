// Light that the scene's file does not have, and its options.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "luxel/base/result.h"
#include "luxel/base/vec.h"
#include "luxel/pipeline/settings/ies_setting.h"
#include "luxel/pipeline/settings/option.h"
#include "luxel/pipeline/settings/sky_setting.h"
#include "luxel/scene/scene.h"

namespace luxel::pipeline {

/// Where the sun stands and how strong it is.
struct Sun {
  float azimuth_deg = 0;     ///< compass bearing: 0 north = -Z, 90 east = +X
  float elevation_deg = 45;  ///< above the horizon, Y being up
  float lux = 0;             ///< E on a surface that faces it [W/m^2 or lux]
};

/// A picture of the surroundings.
struct EnvironmentSetting {
  std::filesystem::path file;
  float rotation_deg = 0;  ///< about the vertical, as a compass turns
  float scale = 1;         ///< of its radiance
};

/// Light that the scene's file does not have.
struct OutsideLight {
  std::optional<EnvironmentSetting> environment;
  std::optional<Rgb> background;  ///< radiance of the surroundings; replaces the file's
  std::optional<Sun> sun;
  std::optional<SkySetting> sky;  ///< with its own sun
  std::vector<IesSetting> ies;    ///< add_profiles() reads them
};

/// --background, --sun, --environment, --sky and --ies.
Options<OutsideLight> outside_light_options();

/// "r,g,b", three numbers >= 0.
Result<Rgb> parse_background(std::string_view text);
/// "FILE", "FILE,rotate_deg" or "FILE,rotate_deg,scale".
Result<EnvironmentSetting> parse_environment(std::string_view text);
/// "azimuth_deg,elevation_deg,lux".
Result<Sun> parse_sun(std::string_view text);

/// The sun's disc is half a degree wide: its shadows have penumbrae.
scene::PunctualLight sun_light(const Sun& sun);

/// The clear day that lights a scene which has no light: the sun stands in the south-east, to the
/// right of and behind one who looks along -Z.
inline constexpr SkySetting kDefaultSky{.azimuth_deg = 135, .elevation_deg = 40};

/// Adds profiles of punctual lights, environment or sky, background and sun to a scene; an
/// environment or a sky without a background beside it replaces the file's background. A scene that
/// then has no light at all gets kDefaultSky, and so does one in which only surfaces emit, and too
/// faintly (about_faint_emission), where no option chose light from outside. Returns warnings; the
/// one that says so comes last, and where there was no light it ends in `about_lost_lights`
/// (import::Imported). `max_memory_bytes`: as in import::import_scene. Errors: those of
/// import::read_environment and add_profiles.
Result<std::vector<std::string>> add_outside_light(const OutsideLight& outside, scene::Scene& scene,
                                                   std::string_view about_lost_lights = {},
                                                   uint64_t max_memory_bytes = 0);

/// True: add_outside_light() brought kDefaultSky. Scene files have no surroundings of their own.
bool is_lit_by_default_day(const OutsideLight& outside, const scene::Scene& scene);

/// Why nothing is lit in a scene that has light: `what` is what stays black.
std::string no_light_arrives(std::string_view what);

}  // namespace luxel::pipeline
