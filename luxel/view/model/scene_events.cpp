#include "luxel/view/model/scene_events.h"

#include <algorithm>
#include <cmath>

#include "luxel/pipeline/settings/sky_setting.h"
#include "luxel/scene/brightness.h"
#include "luxel/scene/light_kinds.h"

namespace luxel::view {
namespace {

using nlohmann::json;

constexpr const char* kSceneKeys[] = {"lamp",        "new_lamp", "material",       "select",
                                      "select_lamp", "instance", "select_material"};

/// The members of an event besides "at" and what it is of: each is read once, and none is left.
class Members {
 public:
  explicit Members(const json& from) : from_(from) {}

  bool has(const char* key) {
    const bool has = from_.contains(key);
    known_ += has;
    return has;
  }
  /// Three numbers, each from `least` on; what is not held is no event.
  void read(const char* key, float least, std::optional<Vec3>& to) {
    if (!has(key)) return;
    const auto v = from_[key].get<std::array<float, 3>>();
    for (const float x : v) is_fine_ &= std::abs(x) <= scene::kBrightest && x >= least;
    to = Vec3{v[0], v[1], v[2]};
  }
  /// A place.
  void read(const char* key, std::optional<DVec3>& to) {
    if (!has(key)) return;
    const auto v = from_[key].get<std::array<double, 3>>();
    for (const double x : v) is_fine_ &= std::abs(x) <= double(scene::kBrightest);
    to = DVec3{v[0], v[1], v[2]};
  }
  /// A number from 0 to `most`.
  void read(const char* key, float most, std::optional<float>& to) {
    if (!has(key)) return;
    to = from_[key].get<float>();
    is_fine_ &= *to >= 0 && *to <= most;
  }
  void refuse() { is_fine_ = false; }
  bool all_fine() const { return is_fine_ && known_ + 2 == from_.size(); }

 private:
  const json& from_;
  size_t known_ = 0;
  bool is_fine_ = true;
};

constexpr float kAny = -scene::kBrightest;

/// The changes in "lamp" and "new_lamp" events; none where a member is wrong or not known.
std::optional<LampChange> lamp_change_of(const json& from) {
  LampChange out;
  Members members(from);
  members.read("to", out.to), members.read("direction", kAny, out.direction);
  members.read("intensity", 0, out.intensity);
  if (members.has("on")) out.is_on = from["on"].get<bool>();
  members.read("cone_deg", 90, out.cone_deg),
      members.read("inner_cone_deg", 90, out.inner_cone_deg);
  members.read("disc_deg", 180, out.disc_deg);
  if (members.has("sun")) {
    const auto words = from["sun"].get<std::string>();
    const auto sky = pipeline::parse_sky(words);
    if (sky) out.direction = -pipeline::sky_params(*sky).towards_sun;
    if (sky) out.sky = SkyAsked{*sky, words};
    if (!sky) members.refuse();
  }
  if (out.direction && !(length(*out.direction) > 0)) members.refuse();
  return members.all_fine() ? std::optional(out) : std::nullopt;
}

std::optional<Event> lamp_event_of(const json& from) {
  if (from.contains("deleted"))
    return from.size() == 3 && from["deleted"] == true
               ? std::optional<Event>(LampRemoved{from.at("lamp").get<uint32_t>()})
               : std::nullopt;
  const auto change = lamp_change_of(from);
  if (!change) return std::nullopt;
  if (from.contains("lamp")) return LampChanged{from["lamp"].get<uint32_t>(), *change};
  const auto kind = scene::kind_named(from.at("new_lamp").get<std::string>());
  return kind ? std::optional<Event>(LampAdded{*kind, *change}) : std::nullopt;
}

std::optional<Event> material_event_of(const json& from) {
  MaterialChanged out;
  out.material = from["material"].get<std::string>();
  Members members(from);
  members.read("radiance", 0, out.radiance), members.read("reflectance", 0, out.base_color);
  members.read("metallic", 1, out.metallic);
  const bool is_surface = out.base_color || out.metallic;
  if (!members.all_fine() || (!out.radiance && !is_surface)) return std::nullopt;
  if (!is_surface) return GlowChanged{out.material, *out.radiance};
  const bool is_color = !out.base_color || max_component(*out.base_color) <= 1;
  return is_color ? std::optional<Event>(out) : std::nullopt;
}

/// A name, or a number as one.
std::string name_of_instance(const json& from) {
  return from.is_number_unsigned() ? std::to_string(from.get<uint32_t>()) : from.get<std::string>();
}

std::optional<Event> instance_event_of(const json& from) {
  InstanceChanged out;
  out.instance = name_of_instance(from["instance"]);
  Members members(from);
  members.read("to", out.to), members.read("angles_deg", kAny, out.angles_deg);
  members.read("scale", kAny, out.scale);
  return members.all_fine() ? std::optional<Event>(out) : std::nullopt;
}

}  // namespace

bool changes_scene(const json& from) {
  return std::ranges::any_of(kSceneKeys, [&](const char* key) { return from.contains(key); });
}

std::optional<Event> scene_event_of(const json& from) {
  if (from.contains("lamp") || from.contains("new_lamp")) return lamp_event_of(from);
  if (from.contains("material")) return material_event_of(from);
  if (from.contains("instance")) return instance_event_of(from);
  if (from.size() != 2) return std::nullopt;
  if (from.contains("select_lamp")) return LampSelected{from["select_lamp"].get<uint32_t>()};
  if (from.contains("select_material"))
    return MaterialSelected{from["select_material"].get<std::string>()};
  return InstanceSelected{name_of_instance(from.at("select"))};
}

}  // namespace luxel::view
