// Panel of selected and probed parts of a hierarchical solution, with the fields that the user may
// change. Dear ImGui draws it.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace luxel::view_window {

/// Light along a line.
struct CurvePlot {
  std::vector<float> at_m, exact, shown;  ///< of each point: its place, E
  std::string unit;
  std::vector<std::string> lines;  ///< numbers under it
};

using FlatPolygon = std::vector<std::array<float, 2>>;

/// A source as a point sees it: convex polygons in its plane [m], up is up.
struct SourcePicture {
  FlatPolygon outline, above;  ///< all of it, and what is above the point's horizon
  std::vector<FlatPolygon> visible;
  std::vector<std::string> lines;  ///< numbers under it
};

struct SelectionPanel {
  std::vector<std::string> tools;
  int tool = 0;                       ///< changed
  std::vector<std::string> selected;  ///< lines on what is selected
  bool can_step = false;              ///< an element is selected
  /// Changed: the number of what is asked for; -1: nothing.
  int step = -1;
  bool asks_for_graph = false, asks_for_nothing = false;
  std::array<bool, 3> graph_shows{};  ///< changed: exact light, as shown, the difference, in space
  float graph_height = 0.3f;          ///< changed: over the line's length
  std::vector<std::string> light;     ///< lines on the probe of irradiance
  std::optional<CurvePlot> curve;
  std::vector<SourcePicture> sources;
  std::string left_out;  ///< on sources that have no picture
  std::string said;      ///< why there is nothing, or that it is being computed
};

/// Opens a window of its own.
void lay_out_selection(SelectionPanel& panel);

}  // namespace luxel::view_window
