#include "luxel/view/model/events.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "luxel/base/file.h"
#include "luxel/base/shown_text.h"
#include "luxel/view/model/bookmarks.h"
#include "luxel/view/model/scene_events.h"
#include "luxel/view/model/tool_events.h"

namespace luxel::view {
namespace {

using nlohmann::json;

constexpr double kLongest_s = 3600;
constexpr float kBrightest = 1e6f;  ///< of a layer, over what it was baked with

std::optional<Button> button_of(const std::string& name) {
  if (name == "left") return Button::left;
  if (name == "middle") return Button::middle;
  if (name == "right") return Button::right;
  return std::nullopt;
}

bool is_key(const std::string& name) {
  const auto is_it = [&](const KeyHelp& key) { return name == key.key; };
  return bookmark_key(name) || std::any_of(std::begin(kKeys), std::end(kKeys), is_it) ||
         std::any_of(std::begin(kLampKeys), std::end(kLampKeys), is_it) ||
         std::any_of(std::begin(kEditKeys), std::end(kEditKeys), is_it) ||
         std::any_of(std::begin(kSelectionKeys), std::end(kSelectionKeys), is_it) ||
         std::any_of(std::begin(kHemicubeKeys), std::end(kHemicubeKeys), is_it);
}

/// The number of a name in a table; none where it has no such name.
template <class Table, class Name>
std::optional<uint32_t> number_of(const std::string& name, const Table& table,
                                  const Name& name_of) {
  for (uint32_t i = 0; i < table.size(); ++i)
    if (name == name_of(table[i])) return i;
  return std::nullopt;
}

/// May throw json::exception.
std::optional<Event> layer_event_of(const json& from) {
  LayerSetting out;
  out.name = from.at("name").get<std::string>();
  out.dimmer = from.value("dimmer", 1.0f);
  const auto color = from.value("color", std::array<float, 3>{1, 1, 1});
  out.color = {color[0], color[1], color[2]};
  const bool is_light = out.dimmer >= 0 && out.dimmer <= kBrightest &&
                        min_component(out.color) >= 0 && max_component(out.color) <= kBrightest;
  return is_light ? std::optional<Event>(LayerChanged{out}) : std::nullopt;
}

/// A part of the light: one that has a name, "bounces", which is as many or fewer, or "bounce",
/// which is as many. May throw json::exception.
std::optional<Event> part_event_of(const json& from) {
  if (from.contains("part")) {
    const auto part = number_of(from["part"].get<std::string>(), kParts,
                                [](const PartName& known) { return known.name; });
    return part ? std::optional<Event>(PartChanged{kParts[*part].light}) : std::nullopt;
  }
  const bool is_one = from.contains("bounce");
  const auto most = from.at(is_one ? "bounce" : "bounces").get<int64_t>();
  if (most < 0 || most > int64_t(kMostBounces)) return std::nullopt;
  return PartChanged{{is_one ? uint32_t(most) : 0, uint32_t(most)}};
}

/// The only member of an object; none where there are others. May throw json::exception.
std::optional<std::pair<std::string, json>> only_member(const json& from) {
  if (!from.is_object() || from.size() != 1) return std::nullopt;
  return std::pair(from.begin().key(), from.begin().value());
}

/// An event for a solver that is looked into. May throw json::exception.
std::optional<Event> solver_event_of(const json& from) {
  if (from.contains("do")) return OwnAsked{from["do"].get<std::string>()};
  if (from.contains("overlay")) {
    const auto member = only_member(from["overlay"]);
    return member ? std::optional<Event>(OverlayChanged{member->first, member->second.get<bool>()})
                  : std::nullopt;
  }
  if (from.contains("set")) {
    const auto member = only_member(from["set"]);
    if (!member) return std::nullopt;
    const auto to = member->second.get<double>();
    return std::isfinite(to) ? std::optional<Event>(SettingChanged{member->first, to})
                             : std::nullopt;
  }
  if (!from.contains("show")) return std::nullopt;
  const auto own = number_of(from["show"].get<std::string>(), kOwnShows,
                             [](const char* known) { return known; });
  return own ? std::optional<Event>(OwnShown{kOwnShows[*own]}) : std::nullopt;
}

/// An event that changes how a bake is shown. May throw json::exception.
std::optional<Event> look_event_of(const json& from) {
  if (from.contains("show")) {
    const auto show = number_of(from["show"].get<std::string>(), kShows,
                                [](const ShowName& known) { return known.name; });
    return show ? std::optional<Event>(ShowChanged{Show(*show)}) : std::nullopt;
  }
  if (from.contains("beside")) {
    const auto mode = number_of(from["beside"].get<std::string>(), kBesideModes,
                                [](const char* known) { return known; });
    return mode ? std::optional<Event>(BesideChanged{BesideMode(*mode)}) : std::nullopt;
  }
  if (from.contains("split")) {
    const auto to = from["split"].get<float>();
    return to >= 0 && to <= 1 ? std::optional<Event>(SplitMoved{to}) : std::nullopt;
  }
  if (from.contains("layer")) return layer_event_of(from["layer"]);
  for (const char* key : {"part", "bounces", "bounce"})
    if (from.contains(key)) return part_event_of(from);
  if (from.contains("probes")) return ProbesChanged{from["probes"].get<bool>()};
  if (from.contains("scale")) {
    const auto to = from["scale"].get<float>();
    return to >= 0.5f && to <= 8 ? std::optional<Event>(ScaleChanged{to}) : std::nullopt;
  }
  if (from.contains("close") && from["close"] == "window") return WindowClosed{};
  if (from.contains("lose") && from["lose"] == "device") return DeviceLost{};
  if (from.contains("open")) return OpenAsked{from["open"].get<std::string>()};
  if (from.contains("channel")) {
    const auto channel = number_of(from["channel"].get<std::string>(), kChannels,
                                   [](const char* known) { return known; });
    return channel ? std::optional<Event>(ChannelChanged{Channel(*channel)}) : std::nullopt;
  }
  for (const bool is_logarithmic : {false, true}) {
    const char* name = is_logarithmic ? "logarithmic_range" : "range";
    if (!from.contains(name)) continue;
    const auto range = from[name].get<std::array<float, 2>>();
    const bool is_range = std::isfinite(range[0]) && std::isfinite(range[1]) &&
                          range[0] < range[1] && (range[0] > 0 || !is_logarithmic);
    if (is_range) return RangeChanged{{range[0], range[1], is_logarithmic}};
  }
  return std::nullopt;
}

/// One event; none where it is something else. May throw json::exception.
std::optional<Event> event_of(const json& from) {
  if (changes_scene(from)) return scene_event_of(from);
  if (uses_tools(from)) return tool_event_of(from);
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
  if (auto own = solver_event_of(from)) return own;
  return look_event_of(from);
}

/// The whole file but its events. May throw json::exception.
bool read_times(const json& from, Play& out) {
  out.frames_per_s = from.value("frames_per_s", out.frames_per_s);
  out.end_s = from.at("end").get<double>();
  return out.frames_per_s >= 1 && out.frames_per_s <= 1000 && out.end_s >= 0 &&
         out.end_s <= kLongest_s;
}

}  // namespace

bool changes_lamps(const Event& event) {
  return std::holds_alternative<LampChanged>(event) || std::holds_alternative<LampAdded>(event) ||
         std::holds_alternative<GlowChanged>(event);
}

bool edits_scene(const Event& event) {
  return std::holds_alternative<InstanceSelected>(event) ||
         std::holds_alternative<LampSelected>(event) ||
         std::holds_alternative<MaterialSelected>(event) ||
         std::holds_alternative<InstanceChanged>(event) ||
         std::holds_alternative<LampRemoved>(event) ||
         std::holds_alternative<MaterialChanged>(event);
}

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
        return fail(ErrorCode::bad_input, "{}, event {}: {} is not an event", name, number,
                    short_message(json_text(from)));
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

Status check_no_inside(const Play& play, const std::string& name) {
  for (const TimedEvent& timed : play.events)
    if (std::holds_alternative<OwnShown>(timed.event) ||
        std::holds_alternative<OverlayChanged>(timed.event) ||
        std::holds_alternative<SettingChanged>(timed.event) ||
        std::holds_alternative<OwnAsked>(timed.event) ||
        std::holds_alternative<ToolChanged>(timed.event) ||
        std::holds_alternative<ToolUsed>(timed.event) ||
        std::holds_alternative<SelectionStepped>(timed.event) ||
        std::holds_alternative<GraphChanged>(timed.event))
      return fail(ErrorCode::bad_input,
                  "{}, at {} s: this works only inside a solver; --inside opens one", name,
                  timed.at_s);
  return {};
}

Result<Play> read_play(const std::filesystem::path& file) {
  LUXEL_TRY(const std::vector<std::byte> bytes, read_file(file));
  return parse_play({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, file.string());
}

}  // namespace luxel::view
