// Events of the tools that look into a hierarchical solution, from files that are played.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>

#include "luxel/view/model/events.h"

namespace luxel::view {

/// True: the keys are those of an event of a tool.
bool uses_tools(const nlohmann::json& from);
/// The event; none where it is something else. May throw json::exception.
std::optional<Event> tool_event_of(const nlohmann::json& from);

}  // namespace luxel::view
