// Events that change a scene, from files that are played.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>

#include "luxel/view/model/events.h"

namespace luxel::view {

/// True: the keys are those of an event that changes a scene.
bool changes_scene(const nlohmann::json& from);
/// The event; none where it is something else. May throw json::exception.
std::optional<Event> scene_event_of(const nlohmann::json& from);

}  // namespace luxel::view
