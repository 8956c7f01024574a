#include <algorithm>
#include <nlohmann/json.hpp>

#include "luxel/base/shown_text.h"
#include "luxel/pipeline/command/light_script.h"
#include "luxel/scene/light_kinds.h"
#include "luxel/scene/origin.h"

namespace luxel::pipeline {
namespace {

using nlohmann::ordered_json;

using scene::short_number;

/// `origin`: of the scene, for a place.
ordered_json numbers_of(Vec3 v, DVec3 origin = {}) {
  return {short_number(v.x, origin.x), short_number(v.y, origin.y), short_number(v.z, origin.z)};
}

ordered_json json_of(const Track& track, DVec3 origin = {}) {
  if (track.keys.size() == 1) return numbers_of(track.keys[0].value, origin);
  ordered_json out = ordered_json::array();
  for (const Track::Key& key : track.keys)
    out.push_back({{"at", key.at_s}, {"value", numbers_of(key.value, origin)}});
  return out;
}

/// An angle within what may be read.
double degrees_of(float rad, double least, double most) {
  return std::clamp(short_number(rad * 180 / kPi), least, most);
}

ordered_json json_of(const LightScript::MovingLight& moving, DVec3 origin) {
  const scene::PunctualLight& light = moving.light;
  ordered_json out{{"kind", scene::name_of(light.kind)}, {"intensity", json_of(moving.intensity)}};
  if (scene::has_position(light.kind)) out["position"] = json_of(moving.position, origin);
  if (scene::has_direction(light.kind)) out["direction"] = json_of(moving.direction);
  if (light.range_m > 0) out["range_m"] = short_number(light.range_m);
  if (!scene::has_cone(light.kind)) return out;
  const double outer = degrees_of(light.outer_cone_rad, 0.01, 90);
  out["inner_cone_deg"] = degrees_of(light.inner_cone_rad, 0, outer);
  out["outer_cone_deg"] = outer;
  return out;
}

void put_camera(const LightScript& script, DVec3 origin, ordered_json& out) {
  if (const auto* name = std::get_if<std::string>(&script.camera)) out["camera"] = *name;
  if (const auto* view = std::get_if<LightScript::View>(&script.camera))
    out["camera"] = {{"eye", numbers_of(view->eye, origin)},
                     {"look_at", numbers_of(view->look_at, origin)},
                     {"fov_deg", view->fov_deg}};
}

void put_exposure(const Exposure& exposure, ordered_json& out) {
  if (!exposure.automatic) out["exposure"] = exposure.stops;
  if (exposure.automatic && exposure.percentile)
    out["exposure"] = fmt::format("auto:{}", *exposure.percentile);
}

}  // namespace

std::string text_of(const LightScript& script, DVec3 origin) {
  ordered_json out{{"frames", script.frames},
                   {"frames_per_second", script.frames_per_second},
                   {"size", {script.width, script.height}}};
  put_camera(script, origin, out);
  put_exposure(script.exposure, out);
  if (script.keep_lights) out["keep_lights"] = true;
  if (script.background) out["background"] = json_of(*script.background);
  out["lights"] = ordered_json::array(), out["emission"] = ordered_json::array();
  for (const LightScript::MovingLight& moving : script.lights)
    out["lights"].push_back(json_of(moving, origin));
  for (const LightScript::Glow& glow : script.glows)
    out["emission"].push_back({{"material", glow.material}, {"radiance", json_of(glow.radiance)}});
  return json_text(out, 1) + "\n";
}

}  // namespace luxel::pipeline
