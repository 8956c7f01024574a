// Clicks, drags and keys that select and probe.
#include <algorithm>

#include "luxel/view/hierarchical/selection.h"

namespace luxel::view {
namespace {

/// A button that goes up so near to where it went down was clicked [pixels].
constexpr float kClickReach = 3;

bool was_clicked(const SelectionDesk& desk) {
  return desk.pressed && length(desk.pointer - *desk.pressed) <= kClickReach;
}

/// The tool that a click with this button uses.
InsideTool tool_of(Button button, const Walk& walk, const SelectionDesk& desk) {
  if (button == Button::left) return desk.tool;
  if (button == Button::middle) return InsideTool::none;
  return walk.keys.contains("shift") ? InsideTool::backprojection : InsideTool::irradiance;
}

bool handle_button(const ButtonChanged& button, const Walk& walk, const Examined& examined,
                   SelectionDesk& desk) {
  if (button.is_down) {
    desk.pressed = desk.pointer;
    desk.drags_graph = button.button == Button::left && desk.tool == InsideTool::graph;
    return desk.drags_graph;
  }
  const bool clicked = was_clicked(desk), dragged = std::exchange(desk.drags_graph, false);
  const auto pressed = std::exchange(desk.pressed, std::nullopt);
  if (dragged) {
    if (!clicked) use_tool({InsideTool::graph, *pressed, desk.pointer}, walk, examined, desk);
    return true;
  }
  const InsideTool tool = tool_of(button.button, walk, desk);
  if (clicked && tool != InsideTool::none && tool != InsideTool::graph)
    use_tool({tool, desk.pointer, std::nullopt}, walk, examined, desk);
  return false;  // the walk had its beginning
}

bool handle_key(const std::string& key, const Walk& walk, const Examined& examined,
                SelectionDesk& desk) {
  if (key == "p") step_selection(SelectionStep::up, examined, desk);
  if (key == "c") step_selection(SelectionStep::down, examined, desk);
  if (key == "n") step_selection(SelectionStep::next, examined, desk);
  if (key == "g") use_tool({InsideTool::graph, std::nullopt, std::nullopt}, walk, examined, desk);
  if (key == "esc") use_tool({InsideTool::none, std::nullopt, std::nullopt}, walk, examined, desk);
  return std::any_of(std::begin(kSelectionKeys), std::end(kSelectionKeys),
                     [&](const KeyHelp& known) { return key == known.key; });
}

void change_graph(const GraphChanged& by, SelectionDesk& desk) {
  for (size_t i = 0; i < by.shows.size(); ++i)
    desk.graph_shows[i] = by.shows[i].value_or(desk.graph_shows[i]);
  desk.graph_height = by.height.value_or(desk.graph_height);
  ++desk.changes;
}

}  // namespace

bool handle_selection(const Event& event, const Walk& walk, const Examined& examined,
                      SelectionDesk& desk) {
  if (const auto* moved = std::get_if<PointerMoved>(&event)) {
    desk.pointer = moved->to;
    desk.changes += desk.drags_graph;
    return false;
  }
  if (const auto* button = std::get_if<ButtonChanged>(&event))
    return handle_button(*button, walk, examined, desk);
  if (const auto* key = std::get_if<KeyChanged>(&event))
    return key->is_down && handle_key(key->key, walk, examined, desk);
  if (const auto* used = std::get_if<ToolUsed>(&event))
    return use_tool(*used, walk, examined, desk), true;
  if (const auto* stepped = std::get_if<SelectionStepped>(&event))
    return step_selection(stepped->step, examined, desk), true;
  if (const auto* graph = std::get_if<GraphChanged>(&event))
    return change_graph(*graph, desk), true;
  const auto* changed = std::get_if<ToolChanged>(&event);
  if (changed) desk.tool = changed->tool, ++desk.changes;
  return changed != nullptr;
}

}  // namespace luxel::view
