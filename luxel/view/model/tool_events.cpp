#include "luxel/view/model/tool_events.h"

#include <algorithm>
#include <cmath>

namespace luxel::view {
namespace {

using nlohmann::json;

/// None where one is not held.
template <size_t N>
std::optional<std::array<double, N>> held_numbers(const json& from) {
  const auto out = from.get<std::array<double, N>>();
  const auto is_held = [](double x) { return std::isfinite(float(x)); };
  return std::all_of(out.begin(), out.end(), is_held) ? std::optional(out) : std::nullopt;
}

/// A pixel or a place, by keys that begin with `before`; counts the keys. May throw
/// json::exception.
std::optional<ToolPlace> tool_place_of(const json& from, const std::string& before, size_t& known) {
  if (const std::string pixel = before + "pixel"; from.contains(pixel)) {
    ++known;
    const auto at = held_numbers<2>(from[pixel]);
    return at ? std::optional(ToolPlace(Vec2{float((*at)[0]), float((*at)[1])})) : std::nullopt;
  }
  const std::string place = before + "place";
  if (!from.contains(place)) return std::nullopt;
  ++known;
  const auto at = held_numbers<3>(from[place]);
  return at ? std::optional(ToolPlace(DVec3{(*at)[0], (*at)[1], (*at)[2]})) : std::nullopt;
}

std::optional<InsideTool> tool_named(const std::string& name) {
  for (size_t i = 0; i < kInsideTools.size(); ++i)
    if (name == kInsideTools[i].name) return InsideTool(i);
  return std::nullopt;
}

/// May throw json::exception.
std::optional<Event> tool_used_of(const json& from) {
  const auto tool = tool_named(from["use"].get<std::string>());
  if (!tool) return std::nullopt;
  ToolUsed out;
  out.tool = *tool;
  size_t keys = 2;  // "at" and the tool
  out.at = tool_place_of(from, "", keys), out.to = tool_place_of(from, "to_", keys);
  const size_t places = size_t(out.at.has_value()) + size_t(out.to.has_value());
  if (from.size() != keys || keys != 2 + places || (out.to && !out.at)) return std::nullopt;
  if (!out.at && out.tool != InsideTool::none && out.tool != InsideTool::graph) return std::nullopt;
  if (out.tool == InsideTool::graph ? out.at.has_value() != out.to.has_value() : out.to.has_value())
    return std::nullopt;
  return out;
}

/// May throw json::exception.
std::optional<Event> graph_changed_of(const json& from) {
  GraphChanged out;
  size_t known = 0;
  for (size_t i = 0; i < kGraphCurves.size(); ++i) {
    if (!from.contains(kGraphCurves[i])) continue;
    out.shows[i] = from[kGraphCurves[i]].get<bool>(), ++known;
  }
  if (from.contains("height")) {
    out.height = from["height"].get<float>(), ++known;
    if (!(*out.height >= kLowestGraph && *out.height <= kHighestGraph)) return std::nullopt;
  }
  return known > 0 && known == from.size() ? std::optional<Event>(out) : std::nullopt;
}

}  // namespace

bool uses_tools(const json& from) {
  return from.contains("tool") || from.contains("use") || from.contains("selection") ||
         from.contains("graph");
}

std::optional<Event> tool_event_of(const json& from) {
  if (from.contains("use")) return tool_used_of(from);
  if (from.size() != 2) return std::nullopt;  // "at" and one of these
  if (from.contains("tool")) {
    const auto tool = tool_named(from["tool"].get<std::string>());
    return tool ? std::optional<Event>(ToolChanged{*tool}) : std::nullopt;
  }
  if (from.contains("graph")) return graph_changed_of(from["graph"]);
  const auto name = from["selection"].get<std::string>();
  for (size_t i = 0; i < kSelectionSteps.size(); ++i)
    if (name == kSelectionSteps[i]) return SelectionStepped{SelectionStep(i)};
  return std::nullopt;
}

}  // namespace luxel::view
