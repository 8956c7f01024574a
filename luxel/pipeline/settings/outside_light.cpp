#include "luxel/pipeline/settings/outside_light.h"

#include <array>
#include <cfloat>
#include <cmath>

#include "luxel/base/shown_text.h"
#include "luxel/import/environment.h"
#include "luxel/pipeline/settings/comma_list.h"
#include "luxel/pipeline/settings/needs_day.h"
#include "luxel/pipeline/settings/option_rows.h"
#include "luxel/scene/brightness.h"
#include "luxel/scene/validate.h"

namespace luxel::pipeline {
namespace {

/// Compared as the scene has it, in float; numbers beyond float are not converted.
bool is_held(double brightness) {
  return brightness <= double(FLT_MAX) && float(brightness) <= scene::kBrightest;
}

/// Three numbers with commas between them.
std::optional<std::array<double, 3>> parse_triple(std::string_view text) {
  const std::vector<std::string_view> words = split_at_commas(text);
  if (words.size() != 3) return std::nullopt;
  std::array<double, 3> values{};
  for (size_t k = 0; k < 3; ++k) {
    const auto value = number_from<double>(words[k]);
    if (!value) return std::nullopt;
    values[k] = *value;
  }
  return values;
}

}  // namespace

Result<Rgb> parse_background(std::string_view text) {
  const auto v = parse_triple(text);
  if (!v || (*v)[0] < 0 || (*v)[1] < 0 || (*v)[2] < 0)
    return fail(ErrorCode::bad_setting,
                "--background '{}' is not a radiance; give three numbers >= 0 as r,g,b", text);
  if (!is_held((*v)[0]) || !is_held((*v)[1]) || !is_held((*v)[2]))
    return fail(ErrorCode::bad_setting, "--background '{}' is too bright; it may be {:g} at most",
                text, scene::kBrightest);
  return Rgb{float((*v)[0]), float((*v)[1]), float((*v)[2])};
}

Result<EnvironmentSetting> parse_environment(std::string_view text) {
  // From the end: a file's name may hold commas.
  std::vector<double> numbers;
  std::string_view file = text;
  while (numbers.size() < 2) {
    const size_t comma = file.rfind(',');
    if (comma == std::string_view::npos) break;
    const auto value = number_from<double>(file.substr(comma + 1));
    if (!value) break;
    numbers.insert(numbers.begin(), *value);
    file = file.substr(0, comma);
  }
  EnvironmentSetting out{std::string(file)};
  if (numbers.size() > 0) out.rotation_deg = float(numbers[0]);
  const double scale = numbers.size() > 1 ? numbers[1] : 1;
  if (!is_held(scale))
    return fail(ErrorCode::bad_setting, "--environment '{}': the scale may be {:g} at most", text,
                scene::kBrightest);
  out.scale = float(scale);
  if (file.empty() || !(out.scale >= 0))
    return fail(ErrorCode::bad_setting,
                "--environment '{}' is not FILE,rotate_deg,scale; the scale is >= 0, as in "
                "--environment sky.hdr,90,0.5",
                text);
  return out;
}

Result<Sun> parse_sun(std::string_view text) {
  const auto v = parse_triple(text);
  if (!v || (*v)[1] < -90 || (*v)[1] > 90 || (*v)[2] < 0)
    return fail(ErrorCode::bad_setting,
                "--sun '{}' is not azimuth_deg,elevation_deg,lux; the elevation is -90 to 90, lux "
                ">= 0, as in --sun 135,45,100",
                text);
  if (!is_held((*v)[2]))
    return fail(ErrorCode::bad_setting, "--sun '{}' is too bright; it may be {:g} lux at most",
                text, scene::kBrightest);
  return Sun{float((*v)[0]), float((*v)[1]), float((*v)[2])};
}

namespace {

using L = OutsideLight;
using nlohmann::json;

template <class T, class Print>
auto when_set(Print print) {
  return [print](const std::optional<T>& value) { return value ? print(*value) : json(); };
}

json numbers(std::initializer_list<float> values) {
  json out = json::array();
  for (const float v : values) out.push_back(json_of_number(v));
  return out;
}

/// "FILE,rotate,scale" from what bake.json holds. Errors: it holds something else.
Result<std::string> environment_text(const json& e) {
  if (!e.is_object() || !e.contains("file"))
    return fail(ErrorCode::bad_setting, "--environment: {} names no file", json_text(e));
  return fmt::format("{},{},{}", e["file"].get<std::string>(), e.value("rotation_deg", 0.0),
                     e.value("scale", 1.0));
}

Option<L> environment_option() {
  Option<L> row =
      Rows<L>::text("--environment", &L::environment, parse_environment,
                    when_set<EnvironmentSetting>([](const EnvironmentSetting& e) {
                      return json{{"file", e.file.string()},
                                  {"rotation_deg", json_of_number(e.rotation_deg)},
                                  {"scale", json_of_number(e.scale)}};
                    }),
                    "Environment map: an equirectangular .hdr or .exr, rotated and scaled")
          .unit("FILE[,ROTATE_DEG[,SCALE]]");
  row.read_json = [read = row.read_text](L& s, const json& value) -> Status {
    LUXEL_TRY(const std::string text, environment_text(value));
    return read(s, text);
  };
  return row;
}

Option<L> sky_option() {
  Option<L> row =
      Rows<L>::text(
          "--sky", &L::sky, parse_sky, when_set<SkySetting>([](const SkySetting& sky) {
            return json{{"azimuth_deg", sky.azimuth_deg},
                        {"elevation_deg", sky.elevation_deg},
                        {"turbidity", sky.turbidity},
                        {"sun_distance_au", sky.sun_distance_au}};
          }),
          "Add a clear sky with its sun, in lux, by the sun's azimuth and elevation or by date, "
          "time and place (2026-06-21T15:30+02:00,48.85,2.35); turbidity: 1 to 10 (default: 2)")
          .unit("AZIMUTH_DEG,ELEVATION_DEG|TIME,LATITUDE,LONGITUDE[,TURBIDITY]")
          .never_with({"--background", "--sun", "--environment"});
  row.read_json = [read = row.read_text](L& s, const json& value) -> Status {
    if (!value.is_object())
      return fail(ErrorCode::bad_setting, "--sky: {} is not a sky", json_text(value));
    LUXEL_TRY_STATUS(
        read(s, fmt::format("{},{},{}", value.value("azimuth_deg", 0.0),
                            value.value("elevation_deg", 45.0), value.value("turbidity", 2.0))));
    // Only a date tells it, and bake.json holds what the date came to.
    s.sky->sun_distance_au = value.value("sun_distance_au", 1.0);
    return {};
  };
  return row;
}

Option<L> ies_option() {
  Option<L> row = Rows<L>::text(
                      "--ies", [](auto& s) -> auto& { return s.ies; },
                      [](std::string_view text) -> Result<std::vector<IesSetting>> {
                        LUXEL_TRY(IesSetting one, parse_ies_setting(text));
                        return std::vector<IesSetting>{std::move(one)};
                      },
                      [](const std::vector<IesSetting>& all) {
                        json out = all.empty() ? json() : json::array();
                        for (const IesSetting& ies : all)
                          out.push_back({{"light", ies.light},
                                         {"lamp", ies.light},  // the key before version 0.2
                                         {"file", ies.file.string()},
                                         {"scale", json_of_number(ies.scale)}});
                        return out;
                      },
                      "Give a point or spot light the distribution in an IES file; repeatable")
                      .unit("LIGHT=FILE[,SCALE]");
  row.repeats = true;
  row.read_text = [](L& s, std::string_view text) -> Status {
    LUXEL_TRY(IesSetting one, parse_ies_setting(text));
    s.ies.push_back(std::move(one));
    return {};
  };
  row.read_json = [read = row.read_text](L& s, const json& list) -> Status {
    s.ies.clear();
    for (const json& one : list)
      LUXEL_TRY_STATUS(read(s, fmt::format("{}={},{}", one.value("light", one.value("lamp", "")),
                                           one.value("file", ""), one.value("scale", 1.0))));
    return {};
  };
  return row;
}

}  // namespace

Options<OutsideLight> outside_light_options() {
  Options<L> rows{Rows<L>::text("--background", &L::background, parse_background,
                                when_set<Rgb>([](const Rgb& c) {
                                  return numbers({c.x, c.y, c.z});
                                }),
                                "Background radiance as r,g,b")
                      .unit("R,G,B"),
                  Rows<L>::text("--sun", &L::sun, parse_sun, when_set<Sun>([](const Sun& sun) {
                                  return numbers({sun.azimuth_deg, sun.elevation_deg, sun.lux});
                                }),
                                "Add a sun: azimuth (0 = -Z, 90 = +X), elevation, and illuminance "
                                "on a surface that faces it")
                      .unit("AZIMUTH_DEG,ELEVATION_DEG,LUX"),
                  environment_option(), sky_option(), ies_option()};
  for (Option<L>& row : rows) row.changes = Changes::scene;
  return rows;
}

scene::PunctualLight sun_light(const Sun& sun) {
  const float azimuth = sun.azimuth_deg * kPi / 180, elevation = sun.elevation_deg * kPi / 180;
  return sun_light(Rgb{1, 1, 1} * sun.lux,
                   {std::sin(azimuth) * std::cos(elevation), std::sin(elevation),
                    -std::cos(azimuth) * std::cos(elevation)});
}

Result<std::vector<std::string>> add_outside_light(const OutsideLight& outside, scene::Scene& scene,
                                                   std::string_view about_lost_lights,
                                                   uint64_t max_memory_bytes) {
  LUXEL_TRY(std::vector<std::string> warnings, add_profiles(outside.ies, scene));
  if (const auto& e = outside.environment) {
    LUXEL_TRY(
        import::ImportedEnvironment imported,
        import::read_environment(e->file, e->rotation_deg * kPi / 180, e->scale, max_memory_bytes));
    scene.environment = std::move(imported.map);
    scene.background = {};
    warnings.insert(warnings.end(), imported.warnings.begin(), imported.warnings.end());
  }
  if (outside.background) scene.background = *outside.background;
  if (outside.sun && outside.sun->lux > 0) scene.lights.push_back(sun_light(*outside.sun));
  if (outside.sky) add_sky(*outside.sky, scene);
  LUXEL_TRY_STATUS(scene::check_brightness(scene, ""));
  if (scene::has_light(scene)) {
    const bool is_chosen = outside.background || outside.sun || outside.environment || outside.sky;
    if (is_chosen || scene::has_lamp_or_sky(scene)) return warnings;
    LUXEL_TRY(const std::string faint, about_faint_emission(scene));
    if (faint.empty()) return warnings;
    add_sky(kDefaultSky, scene);
    warnings.push_back(fmt::format(
        "{}, so a clear sky lights it as well, --sky {},{}; --background 0,0,0 leaves it dark",
        faint, kDefaultSky.azimuth_deg, kDefaultSky.elevation_deg));
    return warnings;
  }
  add_sky(kDefaultSky, scene);
  warnings.push_back(fmt::format(
      "the scene has no light, so a clear sky lights it, --sky {},{}; choose other light with "
      "--sky, --sun, --environment or --background, or add lights to the file{}{}",
      kDefaultSky.azimuth_deg, kDefaultSky.elevation_deg, about_lost_lights.empty() ? "" : "; ",
      about_lost_lights));
  return warnings;
}

bool is_lit_by_default_day(const OutsideLight& outside, const scene::Scene& scene) {
  return !scene.environment.empty() && !outside.environment && !outside.sky;
}

std::string no_light_arrives(std::string_view what) {
  return fmt::format(
      "{} is black because no light gets there; a closed room needs a light or an emissive surface "
      "inside, or an opening: a hole in its walls, or a window of a blended or transmissive "
      "material",
      what);
}

}  // namespace luxel::pipeline
