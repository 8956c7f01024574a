#include "luxel/view/model/events.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "luxel/base/file.h"
#include "luxel/base/short_message.h"
#include "luxel/scene/brightness.h"
#include "luxel/scene/light_kinds.h"

namespace luxel::view {
namespace {

using nlohmann::json;

constexpr double kLongest_s = 3600;

std::optional<Button> button_of(const std::string& name) {
  if (name == "left") return Button::left;
  if (name == "middle") return Button::middle;
  if (name == "right") return Button::right;
  return std::nullopt;
}

bool is_key(const std::string& name) {
  const auto is_it = [&](const KeyHelp& key) { return name == key.key; };
  return std::any_of(std::begin(kKeys), std::end(kKeys), is_it) ||
         std::any_of(std::begin(kLampKeys), std::end(kLampKeys), is_it);
}

/// Three numbers; none where one is not held. May throw json::exception.
std::optional<Vec3> vec3_of(const json& from) {
  const auto v = from.get<std::array<float, 3>>();
  for (const float x : v)
    if (!(std::abs(x) <= scene::kBrightest)) return std::nullopt;
  return Vec3{v[0], v[1], v[2]};
}

/// What "lamp" and "new_lamp" say besides; none where something else is said, too.
std::optional<LampChange> lamp_change_of(const json& from) {
  LampChange out;
  size_t known = 2;  // "at" and which lamp
  const auto read = [&](const char* key, std::optional<Vec3>& to) {
    if (!from.contains(key)) return true;
    to = vec3_of(from[key]);
    return ++known, to.has_value();
  };
  if (!read("to", out.to) || !read("direction", out.direction) || !read("intensity", out.intensity))
    return std::nullopt;
  if (from.contains("on")) ++known, out.is_on = from["on"].get<bool>();
  if (known != from.size() || (out.direction && !(length(*out.direction) > 0)) ||
      (out.intensity && !(min_component(*out.intensity) >= 0)))
    return std::nullopt;
  return out;
}

/// An event of light; none where it is something else. May throw json::exception.
std::optional<Event> light_event_of(const json& from) {
  if (from.contains("material")) {
    if (from.size() != 3) return std::nullopt;
    const auto radiance = vec3_of(from.at("radiance"));
    if (!radiance || !(min_component(*radiance) >= 0)) return std::nullopt;
    return GlowChanged{from["material"].get<std::string>(), *radiance};
  }
  const auto change = lamp_change_of(from);
  if (!change) return std::nullopt;
  if (from.contains("lamp")) return LampChanged{from["lamp"].get<uint32_t>(), *change};
  const auto kind = scene::kind_named(from.at("new_lamp").get<std::string>());
  return kind ? std::optional<Event>(LampAdded{*kind, *change}) : std::nullopt;
}

/// One event; none where it is something else. May throw json::exception.
std::optional<Event> event_of(const json& from) {
  for (const char* key : {"lamp", "new_lamp", "material"})
    if (from.contains(key)) return light_event_of(from);
  if (from.size() != 2) return std::nullopt;  // "at" and what happens
  if (from.contains("pointer")) {
    const auto at = from["pointer"].get<std::array<float, 2>>();
    if (!std::isfinite(at[0]) || !std::isfinite(at[1])) return std::nullopt;
    return PointerMoved{{at[0], at[1]}};
  }
  for (const bool is_down : {true, false}) {
    if (const char* name = is_down ? "press" : "release"; from.contains(name)) {
      const auto button = button_of(from[name].get<std::string>());
      return button ? std::optional<Event>(ButtonChanged{*button, is_down}) : std::nullopt;
    }
    if (const char* name = is_down ? "key" : "key_up"; from.contains(name)) {
      const auto key = from[name].get<std::string>();
      return is_key(key) ? std::optional<Event>(KeyChanged{key, is_down}) : std::nullopt;
    }
  }
  if (from.contains("wait") && from["wait"] == "bake") return WaitForBake{};
  if (from.contains("scroll")) {
    const auto by = from["scroll"].get<float>();
    if (std::abs(by) <= 100) return Scrolled{by};
  }
  return std::nullopt;
}

/// The whole file but its events. May throw json::exception.
bool read_times(const json& from, Play& out) {
  out.frames_per_s = from.value("frames_per_s", out.frames_per_s);
  out.end_s = from.at("end").get<double>();
  return out.frames_per_s >= 1 && out.frames_per_s <= 1000 && out.end_s >= 0 &&
         out.end_s <= kLongest_s;
}

}  // namespace

Result<Play> parse_play(std::string_view text, const std::string& name) {
  Play out;
  size_t number = 0;
  try {
    const json file = json::parse(text);
    if (!read_times(file, out))
      return fail(ErrorCode::bad_input,
                  "{}: frames_per_s is from 1 to 1000 and end from 0 to {} seconds", name,
                  kLongest_s);
    double last = 0;
    for (const json& from : file.at("events")) {
      ++number;
      const auto at = from.at("at").get<double>();
      const auto event = event_of(from);
      if (!event)
        return fail(ErrorCode::bad_input, "{}, event {}: {} is no event", name, number,
                    short_message(from.dump(-1, ' ', true, json::error_handler_t::replace)));
      if (!(at >= last && at <= out.end_s))
        return fail(ErrorCode::bad_input, "{}, event {}: its time, {}, is not from {} to {}", name,
                    number, at, last, out.end_s);
      out.events.push_back({at, *event});
      last = at;
    }
  } catch (const json::exception& e) {
    const std::string where = number > 0 ? fmt::format(", event {}", number) : "";
    return fail(ErrorCode::bad_input, "{}{}: {}", name, where, short_message(e.what(), 400));
  }
  return out;
}

Result<Play> read_play(const std::filesystem::path& file) {
  LUXEL_TRY(const std::vector<std::byte> bytes, read_file(file));
  return parse_play({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, file.string());
}

}  // namespace luxel::view
