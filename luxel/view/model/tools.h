// Tools that look into a hierarchical solution, as a user or a file that is played asks for them.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <variant>

#include "luxel/base/vec_double.h"

namespace luxel::view {

/// With what a hierarchical solution is looked into. [Hardt96, appendices B.4.6 to B.4.10]
enum class InsideTool : uint8_t {
  none,
  element,
  link,
  triangle,
  discontinuity,
  graph,
  irradiance,
  backprojection,
};
/// A name in files that are played, and words for it. In the order of InsideTool.
struct InsideToolName {
  const char *name, *words;
};
inline constexpr std::array<InsideToolName, 8> kInsideTools{{
    {"none", "no tool"},
    {"element", "select an element"},
    {"link", "select a link"},
    {"triangle", "select a triangle"},
    {"discontinuity", "select a discontinuity"},
    {"graph", "graph along a line"},
    {"irradiance", "probe irradiance"},
    {"backprojection", "probe backprojections"},
}};
/// Where a tool is used: a pixel of the picture, or the place of a surface nearest to one in the
/// world of the file.
using ToolPlace = std::variant<Vec2, DVec3>;
/// Clicks use another tool.
struct ToolChanged {
  InsideTool tool = InsideTool::none;
};
/// A tool is used. Without a place it is a graph across what is selected; none: nothing is selected
/// any longer.
struct ToolUsed {
  InsideTool tool = InsideTool::none;
  std::optional<ToolPlace> at, to;  ///< `to`: the end of a graph
};
/// The selection goes up to what holds it, down to its part, or on to the next weaker link.
enum class SelectionStep : uint8_t { up, down, next };
inline constexpr std::array<const char*, 3> kSelectionSteps{"up", "down", "next"};
struct SelectionStepped {
  SelectionStep step = SelectionStep::up;
};

/// Curves of a graph in space: exact light, light as it is shown, the difference.
inline constexpr std::array<const char*, 3> kGraphCurves{"exact", "shown", "difference"};
/// Graphs in space show some curves, and so high; what is not said stays.
struct GraphChanged {
  std::array<std::optional<bool>, kGraphCurves.size()> shows;
  std::optional<float> height;  ///< of the largest value, over the line's length
};
inline constexpr float kLowestGraph = 0.01f, kHighestGraph = 10;

}  // namespace luxel::view
