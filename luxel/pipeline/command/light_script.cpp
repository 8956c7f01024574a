#include "luxel/pipeline/command/light_script.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <span>
#include <string_view>

#include "luxel/base/shown_text.h"
#include "luxel/scene/brightness.h"
#include "luxel/scene/held_range.h"
#include "luxel/scene/light_kinds.h"

namespace luxel::pipeline {
namespace {

using nlohmann::json;

/// One object of the file and where it stands, for messages.
struct Node {
  const json& value;
  std::string where;  ///< "moves.json: lights[0]"
  DVec3 origin;       ///< of the scene

  bool has(const char* field) const { return value.contains(field); }
  Node at(const char* field) const { return {value[field], where + "." + field, origin}; }
  Node at(size_t k) const { return {value[k], fmt::format("{}[{}]", where, k), origin}; }
};

Failure wrong(const Node& node, std::string_view wanted) {
  return fail(ErrorCode::bad_input, "{} is {}; it should be {}", node.where,
              json_text(node.value).substr(0, 60), wanted);
}

Status only_fields(const Node& node, std::span<const std::string_view> known,
                   std::string_view what) {
  if (!node.value.is_object()) return wrong(node, what);
  for (const auto& [field, value] : node.value.items())
    if (std::find(known.begin(), known.end(), field) == known.end()) {
      std::string names;
      for (const std::string_view k : known) names += (names.empty() ? "" : ", ") + std::string(k);
      return fail(ErrorCode::bad_input, "{}: '{}' is not known; choose from: {}", node.where, field,
                  names);
    }
  return {};
}

Result<double> number(const Node& node, double least, double most) {
  if (!node.value.is_number() || !(node.value.get<double>() >= least) ||
      !(node.value.get<double>() <= most))
    return wrong(node, fmt::format("a number from {} to {}", least, most));
  return node.value.get<double>();
}

Result<int> whole_number(const Node& node, int least, int most) {
  const auto value = number(node, least, most);
  if (!value || *value != std::floor(*value))
    return wrong(node, fmt::format("a whole number from {} to {}", least, most));
  return int(*value);
}

Result<DVec3> exact_triple(const Node& node) {
  const bool good = node.value.is_array() && node.value.size() == 3 &&
                    std::all_of(node.value.begin(), node.value.end(),
                                [](const json& v) { return v.is_number(); });
  const DVec3 v = good ? DVec3{node.value[0].get<double>(), node.value[1].get<double>(),
                               node.value[2].get<double>()}
                       : DVec3{};
  if (!good || !is_finite(to_float(v))) return wrong(node, "three numbers, as [1, 2, 0.5]");
  return v;
}
Result<Vec3> triple(const Node& node) {
  LUXEL_TRY(const DVec3 v, exact_triple(node));
  return to_float(v);
}

/// A place in the scene, read as one in the world of its file.
Result<Vec3> place(const Node& node, float farthest_m) {
  LUXEL_TRY(const DVec3 v, exact_triple(node));
  const Vec3 p = to_float(v - node.origin);
  if (scene::is_held(p, farthest_m)) return p;
  return wrong(node, fmt::format("a place with coordinates up to {:g} m", farthest_m));
}
Result<Vec3> place_of_light(const Node& node) { return place(node, scene::kFarthestLight_m); }

/// A value, or keys {"at": seconds, "value": value}.
Result<Track> track(const Node& node, Result<Vec3> (*read)(const Node&) = triple) {
  Track out;
  const bool keyed = node.value.is_array() && !node.value.empty() && node.value[0].is_object();
  if (!keyed) {
    LUXEL_TRY(const Vec3 value, read(node));
    out.keys.push_back({0, value});
    return out;
  }
  constexpr std::array<std::string_view, 2> known{"at", "value"};
  for (size_t k = 0; k < node.value.size(); ++k) {
    const Node key = node.at(k);
    LUXEL_TRY_STATUS(only_fields(key, known, "a key, as {\"at\": 0.5, \"value\": [1, 2, 0.5]}"));
    if (!key.has("at") || !key.has("value"))
      return wrong(key, "a key, as {\"at\": 0.5, \"value\": [1, 2, 0.5]}");
    LUXEL_TRY(const double at_s, number(key.at("at"), -1e6, 1e6));
    LUXEL_TRY(const Vec3 value, read(key.at("value")));
    if (!out.keys.empty() && !(at_s > out.keys.back().at_s))
      return wrong(key.at("at"), "later than the key before it");
    out.keys.push_back({at_s, value});
  }
  return out;
}

/// Light up to `brightest`, as scene::check_brightness() asks of the lights of files.
Result<Track> light_track(const Node& node, float brightest = scene::kBrightest) {
  LUXEL_TRY(Track out, track(node));
  for (const Track::Key& key : out.keys) {
    if (min_component(key.value) < 0) return wrong(node, "light, which is never negative");
    if (max_component(key.value) > brightest)
      return wrong(node, fmt::format("light of at most {:g}", brightest));
  }
  return out;
}

Result<Track> direction_track(const Node& node) {
  LUXEL_TRY(Track out, track(node));
  for (Track::Key& key : out.keys) {
    if (!scene::has_unit_vector(key.value))
      return wrong(node, "a direction that is not 0, 0, 0, of a length up to 1e19");
    key.value = normalize(key.value);
  }
  return out;
}

Result<scene::PunctualLight::Kind> kind_of(const Node& node) {
  if (node.value.is_string())
    if (const auto kind = scene::kind_named(node.value.get<std::string>())) return *kind;
  return wrong(node, "\"point\", \"spot\" or \"directional\"");
}

Status read_cone(const Node& node, scene::PunctualLight& light) {
  double inner = 0, outer = 45;
  if (node.has("outer_cone_deg")) {
    LUXEL_TRY(outer, number(node.at("outer_cone_deg"), 0.01, 90));
  }
  if (node.has("inner_cone_deg")) {
    LUXEL_TRY(inner, number(node.at("inner_cone_deg"), 0, outer));
  }
  light.inner_cone_rad = float(inner) * kPi / 180, light.outer_cone_rad = float(outer) * kPi / 180;
  return {};
}

Result<LightScript::MovingLight> light_of(const Node& node) {
  constexpr std::array<std::string_view, 7> known{
      "kind", "intensity", "position", "direction", "range_m", "inner_cone_deg", "outer_cone_deg"};
  LUXEL_TRY_STATUS(only_fields(node, known, "a light, as {\"kind\": \"point\", ...}"));
  // Defaults of members that may be left out.
  LightScript::MovingLight moving;
  moving.position.keys = {{0, {}}}, moving.direction.keys = {{0, {0, -1, 0}}};
  moving.intensity.keys = {{0, {1, 1, 1}}};
  if (node.has("kind")) {
    LUXEL_TRY(moving.light.kind, kind_of(node.at("kind")));
  }
  // The kind decides what must be there.
  const bool has_place = scene::has_position(moving.light.kind);
  const bool has_direction = scene::has_direction(moving.light.kind);
  if (has_place != node.has("position"))
    return fail(ErrorCode::bad_input, "{}: {}", node.where,
                has_place ? "a point or spot light needs a position"
                          : "a directional light has no position; leave it out");
  if (has_direction != node.has("direction"))
    return fail(ErrorCode::bad_input, "{}: {}", node.where,
                has_direction ? "a spot or directional light needs a direction"
                              : "a point light has no direction; leave it out");
  // The values.
  if (has_place) {
    LUXEL_TRY(moving.position, track(node.at("position"), place_of_light));
  }
  if (has_direction) {
    LUXEL_TRY(moving.direction, direction_track(node.at("direction")));
  }
  if (node.has("intensity")) {
    const float brightest = has_place ? scene::kMostIntensity : scene::kBrightest;
    LUXEL_TRY(moving.intensity, light_track(node.at("intensity"), brightest));
  }
  if (node.has("range_m")) {
    LUXEL_TRY(const double range, number(node.at("range_m"), 0, 1e9));
    moving.light.range_m = float(range);
  }
  LUXEL_TRY_STATUS(read_cone(node, moving.light));
  return moving;
}

Result<LightScript::Glow> glow_of(const Node& node) {
  constexpr std::array<std::string_view, 2> known{"material", "radiance"};
  constexpr std::string_view wanted =
      "a glowing material, as {\"material\": \"lamp\", \"radiance\": [10, 9, 8]}";
  LUXEL_TRY_STATUS(only_fields(node, known, wanted));
  if (!node.has("material") || !node.at("material").value.is_string() || !node.has("radiance"))
    return wrong(node, wanted);
  LightScript::Glow glow;
  glow.material = node.value["material"].get<std::string>();
  LUXEL_TRY(glow.radiance, light_track(node.at("radiance")));
  return glow;
}

Status read_camera(const Node& node, LightScript& out) {
  if (node.value.is_string()) {
    out.camera = node.value.get<std::string>();
    return {};
  }
  constexpr std::array<std::string_view, 3> known{"eye", "look_at", "fov_deg"};
  constexpr std::string_view wanted =
      "a camera's name, or {\"eye\": [x, y, z], \"look_at\": [x, y, z], \"fov_deg\": 45}";
  LUXEL_TRY_STATUS(only_fields(node, known, wanted));
  if (!node.has("eye") || !node.has("look_at")) return wrong(node, wanted);
  LightScript::View view;
  LUXEL_TRY(view.eye, place(node.at("eye"), scene::kFarthest_m));
  LUXEL_TRY(view.look_at, place(node.at("look_at"), scene::kFarthest_m));
  if (view.eye == view.look_at) return wrong(node, "a camera that looks somewhere");
  if (node.has("fov_deg")) {
    LUXEL_TRY(view.fov_deg, number(node.at("fov_deg"), 1, 170));
  }
  out.camera = view;
  return {};
}

Status read_size(const Node& node, LightScript& out) {
  if (!node.value.is_array() || node.value.size() != 2) return wrong(node, "[width, height]");
  LUXEL_TRY(out.width, whole_number(node.at(size_t(0)), 1, 8192));
  LUXEL_TRY(out.height, whole_number(node.at(size_t(1)), 1, 8192));
  return {};
}

Status read_timing(const Node& root, LightScript& out) {
  if (root.has("frames")) {
    LUXEL_TRY(out.frames, whole_number(root.at("frames"), 1, 100000));
  }
  if (root.has("frames_per_second")) {
    LUXEL_TRY(out.frames_per_second, number(root.at("frames_per_second"), 0.001, 1000));
  }
  return {};
}

Status read_picture(const Node& root, LightScript& out) {
  if (root.has("size")) LUXEL_TRY_STATUS(read_size(root.at("size"), out));
  if (root.has("camera")) LUXEL_TRY_STATUS(read_camera(root.at("camera"), out));
  if (root.has("exposure")) {
    const json& value = root.value["exposure"];
    const std::string text = value.is_string() ? value.get<std::string>() : json_text(value);
    const auto exposure = parse_exposure(text);
    if (!exposure) return wrong(root.at("exposure"), "\"auto\" or a number of stops");
    out.exposure = *exposure;
  }
  return {};
}

Status read_lights(const Node& root, LightScript& out) {
  for (const char* list : {"lights", "emission"})
    if (root.has(list) && !root.value[list].is_array())
      return wrong(root.at(list), "a list, [...]");
  for (size_t k = 0; root.has("lights") && k < root.value["lights"].size(); ++k) {
    LUXEL_TRY(LightScript::MovingLight moving, light_of(root.at("lights").at(k)));
    out.lights.push_back(std::move(moving));
  }
  for (size_t k = 0; root.has("emission") && k < root.value["emission"].size(); ++k) {
    LUXEL_TRY(LightScript::Glow glow, glow_of(root.at("emission").at(k)));
    out.glows.push_back(std::move(glow));
  }
  if (root.has("keep_lights")) {
    if (!root.value["keep_lights"].is_boolean())
      return wrong(root.at("keep_lights"), "true or false");
    out.keep_lights = root.value["keep_lights"].get<bool>();
  }
  if (root.has("background")) {
    LUXEL_TRY(out.background, light_track(root.at("background")));
  }
  return {};
}

}  // namespace

Vec3 value_at(const Track& track, double time_s) {
  const auto after = std::find_if(track.keys.begin(), track.keys.end(),
                                  [time_s](const Track::Key& key) { return key.at_s > time_s; });
  if (after == track.keys.begin()) return track.keys.front().value;
  if (after == track.keys.end()) return track.keys.back().value;
  const Track::Key& before = *(after - 1);
  const auto share = float((time_s - before.at_s) / (after->at_s - before.at_s));
  return before.value * (1 - share) + after->value * share;
}

Result<LightScript> parse_light_script(const std::string& text, const std::string& name,
                                       DVec3 origin) {
  // Deeper than any script: dump() would recurse until the stack ends.
  bool too_deep = false;
  const auto look = [&too_deep](int depth, json::parse_event_t, json&) {
    too_deep = too_deep || depth > 32;
    return true;
  };
  const json document = json::parse(text, look, false);
  if (document.is_discarded() || too_deep)
    return fail(ErrorCode::bad_input,
                "{}: it is not JSON that could be a script; look for a missing comma or bracket",
                name);
  const Node root{document, name, origin};
  constexpr std::array<std::string_view, 9> known{"frames",      "frames_per_second", "size",
                                                  "camera",      "exposure",          "lights",
                                                  "keep_lights", "emission",          "background"};
  LUXEL_TRY_STATUS(only_fields(root, known, "an object, {...}"));
  LightScript out;
  LUXEL_TRY_STATUS(read_timing(root, out));
  LUXEL_TRY_STATUS(read_picture(root, out));
  LUXEL_TRY_STATUS(read_lights(root, out));
  return out;
}

std::vector<scene::PunctualLight> lights_at(const LightScript& script, double time_s) {
  std::vector<scene::PunctualLight> out;
  for (const LightScript::MovingLight& moving : script.lights) {
    scene::PunctualLight light = moving.light;
    light.intensity = value_at(moving.intensity, time_s);
    light.position = value_at(moving.position, time_s);
    // Between two directions the mean may vanish; then the first one holds.
    const Vec3 direction = value_at(moving.direction, time_s);
    light.direction = dot(direction, direction) > 1e-12f ? normalize(direction)
                                                         : moving.direction.keys.front().value;
    out.push_back(light);
  }
  return out;
}

}  // namespace luxel::pipeline
