#include "luxel/pipeline/settings/settings.h"

#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "luxel/atlas/pages.h"
#include "luxel/export/view_page.h"
#include "luxel/import/environment.h"
#include "luxel/pipeline/settings/comma_list.h"
#include "luxel/scene/validate.h"
#include "luxel/solve/hemicube/hemicube.h"
#include "luxel/solve/matrix/patches.h"

namespace luxel::pipeline {
namespace {

constexpr int kMaxSamples = 65535, kMaxSupersample = 1024;
constexpr int64_t kMaxElements = 1 << 26;
constexpr double kSmallestError = 1e-4;
constexpr double kLongestCheckpoint_s = 1e6;
constexpr double kLongestBudget = 1e7;  ///< [s], some months

/// A number that is the whole of `text`.
std::optional<double> parse_number(std::string_view text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value))
    return std::nullopt;
  return value;
}

/// Three numbers with commas between them.
std::optional<std::array<double, 3>> parse_triple(std::string_view text) {
  const std::vector<std::string_view> words = split_at_commas(text);
  if (words.size() != 3) return std::nullopt;
  std::array<double, 3> values{};
  for (size_t k = 0; k < 3; ++k) {
    const auto value = parse_number(words[k]);
    if (!value) return std::nullopt;
    values[k] = *value;
  }
  return values;
}

Status check_range(const char* option, int value, int low, int high) {
  if (value >= low && value <= high) return {};
  return fail(ErrorCode::bad_setting, "{} {} is outside {} to {}", option, value, low, high);
}

/// What a hemicube of this size would hold before anything is seen.
std::string hemicube_memory(int resolution) {
  const double gib = double(hemicube::bytes_of_hemicube(resolution, 1)) / double(1u << 30);
  return gib < 0.1 ? std::string() : fmt::format("; it would take {:.1f} GiB for its pixels", gib);
}

std::string pages_text(const PagesSetting& pages) {
  return pages.mode == atlas::PageMode::automatic      ? "auto"
         : pages.mode == atlas::PageMode::per_instance ? "mesh"
                                                       : fmt::format("{}", pages.count);
}

const char* name_of(atlas::UvMode mode) {
  return mode == atlas::UvMode::keep ? "keep" : mode == atlas::UvMode::unwrap ? "unwrap" : "auto";
}

std::string_view name_of(light::LayerMode mode) {
  return mode == light::LayerMode::per_light ? "per-light"
         : mode == light::LayerMode::groups  ? "groups"
                                             : "none";
}

}  // namespace

Result<light::LayerMode> parse_layers(std::string_view text) {
  if (text == "per-light") return light::LayerMode::per_light;
  if (text == "groups") return light::LayerMode::groups;
  return fail(ErrorCode::bad_setting, "--layers '{}' is not known; there is: per-light, groups",
              text);
}

Result<PagesSetting> parse_pages(std::string_view text) {
  if (text == "auto") return PagesSetting{atlas::PageMode::automatic, 1};
  if (text == "mesh") return PagesSetting{atlas::PageMode::per_instance, 1};
  const auto count = parse_number(text);
  if (!count || *count < 1 || *count > atlas::kMaxPages || *count != std::floor(*count))
    return fail(ErrorCode::bad_setting,
                "--pages '{}' is not a number of lightmaps; give 1 to {}, auto for as many as it "
                "takes, or mesh for one per mesh",
                text, atlas::kMaxPages);
  return PagesSetting{atlas::PageMode::fixed, int(*count)};
}

Status check(const HemicubeSettings& s) {
  if (s.elements != "vertex" && s.elements != "triangle")
    return fail(ErrorCode::bad_setting, "--elements {} is neither vertex nor triangle", s.elements);
  if (s.resolution < 2 || s.resolution > hemicube::kMaxResolution)
    return fail(ErrorCode::bad_setting, "--hemicube {} is outside 2 to {} pixels{}", s.resolution,
                hemicube::kMaxResolution, hemicube_memory(std::max(s.resolution, 0)));
  if (s.resolution % 2 != 0)
    return fail(ErrorCode::bad_setting,
                "--hemicube {} is odd, and its sides are half as high as wide; give an even number",
                s.resolution);
  // The solver has floats; what is nothing to them would be taken for the default.
  const float size_m = float(s.element_size_m);
  if (!std::isfinite(size_m) || size_m < 0 || (size_m == 0 && s.element_size_m != 0))
    return fail(ErrorCode::bad_setting, "--element-size {} is not a length; give metres > 0",
                s.element_size_m);
  if (s.max_elements < 0 || s.max_elements > kMaxElements)
    return fail(ErrorCode::bad_setting, "--max-elements {} is outside 1 to {}", s.max_elements,
                kMaxElements);
  if (!(s.max_error >= 0) || s.max_error > 1e6)
    return fail(ErrorCode::bad_setting,
                "--max-error {} is not an error; give a part of the light, as 0.01, or 0 for no "
                "refinement",
                s.max_error);
  return {};
}

Status check(const MatrixSettings& s) {
  LUXEL_TRY_STATUS(check_range("--patches", s.patches, 1, int64_t(matrix::kMaxPatches)));
  return check_range("--rays", s.rays, 1, kMaxSamples);
}

Status check(const HierarchicalSettings& s) {
  if (s.eps && !(*s.eps >= 0 && std::isfinite(*s.eps)))
    return fail(ErrorCode::bad_setting, "--eps {} is not an error; give W/m^2 >= 0", *s.eps);
  if (!(s.min_area_m2 >= 0 && std::isfinite(s.min_area_m2)))
    return fail(ErrorCode::bad_setting, "--min-area {} is not an area; give m^2 >= 0",
                s.min_area_m2);
  if (s.min_weight && !(*s.min_weight >= 0 && std::isfinite(*s.min_weight)))
    return fail(ErrorCode::bad_setting, "--min-weight {} is not a weight; give W/m^2 per m >= 0",
                *s.min_weight);
  if (s.ranking != "slope" && s.ranking != "nearness")
    return fail(ErrorCode::bad_setting, "--ranking {} is not known; there is: slope, nearness",
                s.ranking);
  return check_range("--max-leaf-lines", s.max_leaf_lines, 0, 1000);
}

namespace {

/// What one option says must not be said by another.
Status check_pages(const BakeSettings& s) {
  const bool one = s.pages.mode == atlas::PageMode::fixed && s.pages.count == 1;
  if (one) return {};
  const std::string pages = pages_text(s.pages);
  if (s.uv == atlas::UvMode::keep)
    return fail(ErrorCode::bad_setting,
                "--uv keep takes the file's layout, which is one lightmap, and --pages {} asks for "
                "others; leave one of them out",
                pages);
  if (s.pages.mode == atlas::PageMode::fixed && s.texels_per_metre > 0)
    return fail(
        ErrorCode::bad_setting,
        "--texels-per-metre {} says how many texels there are, and so does --pages {}; give "
        "--pages auto, or a --resolution instead of the density",
        s.texels_per_metre, pages);
  return {};
}

/// What each light's own lightmap is not made for yet.
Status check_layers(const BakeSettings& s) {
  if (s.layers == light::LayerMode::none) return {};
  const char* other = s.denoise                            ? "--denoise"
                      : s.directional != Directional::none ? "--directional"
                      : s.probe_spacing_m > 0              ? "--probes"
                      : s.resume                           ? "--resume"
                                                           : nullptr;
  if (other)
    return fail(ErrorCode::bad_setting,
                "--layers {} does not go together with {}, which looks at all light at once; leave "
                "one of them out",
                name_of(s.layers), other);
  return {};
}

/// What a bake that is kept, or built on one, does not do.
Status check_keep(const BakeSettings& s) {
  if (!s.keep) return {};
  if (s.resume)
    return fail(ErrorCode::bad_setting,
                "--keep does not go together with --resume: a bake that is to be kept has no "
                "checkpoint; leave one of them out");
  if (s.time_budget_s > 0)
    return fail(ErrorCode::bad_setting,
                "--keep does not go together with --time-budget {}: what is kept should not depend "
                "on the clock; use --max-error",
                s.time_budget_s);
  return {};
}

}  // namespace

Status check_values(const BakeSettings& s) {
  LUXEL_TRY_STATUS(check_range("--resolution", s.resolution, 1, 16384));
  LUXEL_TRY_STATUS(check_range("--samples", s.samples, 1, kMaxSamples));
  LUXEL_TRY_STATUS(check_range("--direct-samples", s.direct_samples, 1, kMaxSamples));
  LUXEL_TRY_STATUS(check_range("--supersample", s.supersample, 1, kMaxSupersample));
  LUXEL_TRY_STATUS(check_range("--threads", s.threads, 0, 1024));
  if (s.max_error != 0 && !(s.max_error >= kSmallestError && s.max_error <= 1))
    return fail(ErrorCode::bad_setting,
                "--max-error {} is outside {} to 1; give the part of their light to which texels "
                "must be known, as 0.02",
                s.max_error, kSmallestError);
  if (!(s.time_budget_s >= 0 && s.time_budget_s <= kLongestBudget))
    return fail(ErrorCode::bad_setting,
                "--time-budget {} is not a time to bake in; give seconds, as 60", s.time_budget_s);
  if (!std::isfinite(s.texels_per_metre) || s.texels_per_metre < 0)
    return fail(ErrorCode::bad_setting, "--texels-per-metre {} is not a density; give a number > 0",
                s.texels_per_metre);
  if (!std::isfinite(s.probe_spacing_m) || s.probe_spacing_m < 0)
    return fail(ErrorCode::bad_setting, "--probes {} is not a spacing; give metres > 0",
                s.probe_spacing_m);
  if (!(s.checkpoint_s >= 0 && s.checkpoint_s <= kLongestCheckpoint_s))
    return fail(ErrorCode::bad_setting,
                "--checkpoint {} is outside 0 to {} seconds; 0 keeps nothing", s.checkpoint_s,
                kLongestCheckpoint_s);
  LUXEL_TRY_STATUS(check_pages(s));
  LUXEL_TRY_STATUS(check_layers(s));
  LUXEL_TRY_STATUS(check_keep(s));
  if (s.html) LUXEL_TRY_STATUS(export_::check_view_page());
  LUXEL_TRY_STATUS(check(s.matrix));
  LUXEL_TRY_STATUS(check(s.hierarchical));
  return check(s.hemicube);
}

nlohmann::json to_json(const BakeSettings& s) {
  nlohmann::json json{{"scene", s.scene.string()},
                      {"solver", s.solver},
                      {"resolution", s.resolution},
                      {"texels_per_metre", s.texels_per_metre},
                      {"pages", pages_text(s.pages)},
                      {"uv", name_of(s.uv)},
                      {"samples", s.samples},
                      {"direct_samples", s.direct_samples},
                      {"max_error", s.max_error},
                      {"supersample", s.supersample},
                      {"max_memory_bytes", s.max_memory_bytes},
                      {"seed", s.seed},
                      {"threads", s.threads}};
  json["formats"] = to_json(s.formats);
  json["html"] = s.html, json["texels"] = s.texels;
  json["error_map"] = s.error_map, json["time_budget_s"] = s.time_budget_s;
  json["checkpoint_s"] = s.checkpoint_s, json["keep"] = s.keep;
  json["bounces"] = s.bounces < 0 ? nlohmann::json("inf") : nlohmann::json(s.bounces);
  json["directional"] = name_of(s.directional);
  json["probe_spacing_m"] = s.probe_spacing_m;
  json["layers"] = name_of(s.layers);
  json["denoise"] = s.denoise, json["stitch"] = s.stitch;
  json["repair_leaks"] = s.repair_leaks;
  if (s.solver == "hemicube")
    json["hemicube"] = {{"elements", s.hemicube.elements},
                        {"resolution", s.hemicube.resolution},
                        {"element_size_m", s.hemicube.element_size_m},
                        {"max_elements", s.hemicube.max_elements},
                        {"max_error", s.hemicube.max_error},
                        {"smooth", s.hemicube.smooth},
                        {"vertex_colors", s.vertex_colors}};
  if (s.solver == "matrix")
    json["matrix"] = {{"patches", s.matrix.patches}, {"rays", s.matrix.rays}};
  if (s.solver == "hierarchical") {
    const HierarchicalSettings& h = s.hierarchical;
    json["hierarchical"] = {{"min_area_m2", h.min_area_m2},
                            {"discontinuities", h.discontinuities},
                            {"max_leaf_lines", h.max_leaf_lines},
                            {"ranking", h.ranking}};
    json["hierarchical"]["eps"] = h.eps ? nlohmann::json(*h.eps) : nlohmann::json("auto");
    json["hierarchical"]["min_weight"] =
        h.min_weight ? nlohmann::json(*h.min_weight) : nlohmann::json("auto");
  }
  if (const auto& b = s.outside.background) json["background"] = {b->x, b->y, b->z};
  if (const auto& e = s.outside.environment)
    json["environment"] = {
        {"file", e->file.string()}, {"rotation_deg", e->rotation_deg}, {"scale", e->scale}};
  if (const auto& sun = s.outside.sun)
    json["sun"] = {sun->azimuth_deg, sun->elevation_deg, sun->lux};
  if (const auto& sky = s.outside.sky)
    json["sky"] = {{"azimuth_deg", sky->azimuth_deg},
                   {"elevation_deg", sky->elevation_deg},
                   {"turbidity", sky->turbidity},
                   {"sun_distance_au", sky->sun_distance_au}};
  for (const IesSetting& ies : s.outside.ies)
    json["ies"].push_back({{"lamp", ies.lamp}, {"file", ies.file.string()}, {"scale", ies.scale}});
  return json;
}

Result<Directional> parse_directional(std::string_view text) {
  if (text == "dominant") return Directional::dominant;
  if (text == "sh1") return Directional::sh1;
  return fail(ErrorCode::bad_setting, "--directional '{}' is not known; there is: dominant, sh1",
              text);
}

std::string_view name_of(Directional directional) {
  return directional == Directional::sh1        ? "sh1"
         : directional == Directional::dominant ? "dominant"
                                                : "none";
}

Result<Rgb> parse_background(std::string_view text) {
  const auto v = parse_triple(text);
  if (!v || (*v)[0] < 0 || (*v)[1] < 0 || (*v)[2] < 0)
    return fail(ErrorCode::bad_setting,
                "--background '{}' is not a radiance; give three numbers >= 0 as r,g,b", text);
  return Rgb{float((*v)[0]), float((*v)[1]), float((*v)[2])};
}

Result<EnvironmentSetting> parse_environment(std::string_view text) {
  // From the end: a file's name may hold commas.
  std::vector<double> numbers;
  std::string_view file = text;
  while (numbers.size() < 2) {
    const size_t comma = file.rfind(',');
    if (comma == std::string_view::npos) break;
    const auto value = parse_number(file.substr(comma + 1));
    if (!value) break;
    numbers.insert(numbers.begin(), *value);
    file = file.substr(0, comma);
  }
  EnvironmentSetting out{std::string(file)};
  if (numbers.size() > 0) out.rotation_deg = float(numbers[0]);
  if (numbers.size() > 1) out.scale = float(numbers[1]);
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
  return Sun{float((*v)[0]), float((*v)[1]), float((*v)[2])};
}

Result<uint64_t> parse_size(std::string_view text) {
  std::string_view number = text;
  double unit = 1;
  const size_t power =
      text.empty() ? std::string_view::npos : std::string_view("KMGTkmgt").find(text.back());
  if (power != std::string_view::npos) {
    unit = std::pow(1024.0, double(power % 4 + 1));
    number.remove_suffix(1);
  }
  const auto value = parse_number(number);
  if (!value || *value <= 0 || *value * unit > 1e18)
    return fail(ErrorCode::bad_setting,
                "--max-memory '{}' is not a size; give bytes, or 900M, 1.5G", text);
  return uint64_t(*value * unit);
}

Result<int> parse_bounces(std::string_view text) {
  if (text == "inf") return -1;
  const auto value = parse_number(text);
  if (!value || *value < 0 || *value > 1e6 || *value != std::floor(*value))
    return fail(ErrorCode::bad_setting,
                "--bounces '{}' is not a number of bounces; give 0, 1, 2, ... or inf", text);
  return int(*value);
}

scene::PunctualLight sun_light(const Sun& sun) {
  const float azimuth = sun.azimuth_deg * kPi / 180, elevation = sun.elevation_deg * kPi / 180;
  return sun_lamp(Rgb{1, 1, 1} * sun.lux,
                  {std::sin(azimuth) * std::cos(elevation), std::sin(elevation),
                   -std::cos(azimuth) * std::cos(elevation)});
}

Result<std::vector<std::string>> add_outside_light(const OutsideLight& outside,
                                                   scene::Scene& scene) {
  LUXEL_TRY(std::vector<std::string> warnings, add_profiles(outside.ies, scene));
  if (const auto& e = outside.environment) {
    LUXEL_TRY(import::ImportedEnvironment imported,
              import::read_environment(e->file, e->rotation_deg * kPi / 180, e->scale));
    scene.environment = std::move(imported.map);
    scene.background = {};
    warnings.insert(warnings.end(), imported.warnings.begin(), imported.warnings.end());
  }
  if (outside.background) scene.background = *outside.background;
  if (outside.sun && outside.sun->lux > 0) scene.lights.push_back(sun_light(*outside.sun));
  if (outside.sky) add_sky(*outside.sky, scene);
  if (scene::has_light(scene)) return warnings;
  scene.background = {1, 1, 1};
  warnings.push_back(
      "the scene has no light: lit by a white background of radiance 1; --background, "
      "--environment, --sky and --sun give others");
  return warnings;
}

}  // namespace luxel::pipeline
