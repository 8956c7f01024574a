#include "apps/view/selection_panel.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "apps/view/ui_text.h"

namespace luxel::view_window {
namespace {

constexpr ImU32 kBlue = IM_COL32(90, 140, 255, 255), kRed = IM_COL32(235, 75, 60, 255),
                kViolet = IM_COL32(120, 60, 170, 255), kGround = IM_COL32(40, 40, 44, 255),
                kSeen = IM_COL32(245, 245, 245, 255), kHorizon = IM_COL32(85, 85, 90, 255),
                kLetters = IM_COL32(215, 215, 215, 255), kZero = IM_COL32(110, 110, 110, 255);

void lay_out_lines(const std::vector<std::string>& lines) {
  ImGui::PushTextWrapPos(ImGui::GetFontSize() * 32);
  for (const std::string& line : lines) lay_out_text(line);
  ImGui::PopTextWrapPos();
}

/// A graph's frame on the screen, and the values at its lower and upper edge.
struct GraphFrame {
  ImVec2 from, extent;
  float low = 0, high = 1, length_m = 1;

  ImVec2 at(float x_m, float value) const {
    return {from.x + extent.x * x_m / length_m,
            from.y + extent.y * (high - value) / std::max(high - low, 1e-30f)};
  }
};

GraphFrame begin_graph(float height, float low, float high, float length_m) {
  const float size = ImGui::GetFontSize();
  const GraphFrame frame{
      ImGui::GetCursorScreenPos(), {size * 32, size * height}, low, high, length_m};
  ImDrawList& list = *ImGui::GetWindowDrawList();
  list.AddRectFilled(frame.from, {frame.from.x + frame.extent.x, frame.from.y + frame.extent.y},
                     kGround);
  if (low <= 0 && high >= 0) list.AddLine(frame.at(0, 0), frame.at(length_m, 0), kZero);
  return frame;
}

void draw_curve(const GraphFrame& frame, const std::vector<float>& at_m,
                const std::vector<float>& value, ImU32 color) {
  std::vector<ImVec2> points;
  for (size_t k = 0; k < at_m.size(); ++k) points.push_back(frame.at(at_m[k], value[k]));
  ImGui::GetWindowDrawList()->AddPolyline(points.data(), int(points.size()), color, 0, 1.5f);
}

/// The values at both edges.
void end_graph(const GraphFrame& frame, const std::string& unit) {
  ImDrawList& list = *ImGui::GetWindowDrawList();
  char label[64];
  snprintf(label, sizeof(label), "%.4g %s", double(frame.high), unit.c_str());
  list.AddText({frame.from.x + 3, frame.from.y + 1}, kLetters, label);
  snprintf(label, sizeof(label), "%.4g", double(frame.low));
  list.AddText({frame.from.x + 3, frame.from.y + frame.extent.y - ImGui::GetFontSize() - 1},
               kLetters, label);
  ImGui::Dummy(frame.extent);
}

/// Exact light and what is shown, and below it the difference on a scale of its own.
void lay_out_curve(const CurvePlot& plot) {
  if (plot.at_m.empty()) return;
  const float length_m = plot.at_m.back() + plot.at_m.front();
  std::vector<float> off;
  float low = INFINITY, high = 0, most = 1e-30f;
  for (size_t k = 0; k < plot.at_m.size(); ++k) {
    off.push_back(plot.shown[k] - plot.exact[k]);
    low = std::min({low, plot.exact[k], plot.shown[k]});
    high = std::max({high, plot.exact[k], plot.shown[k]});
    most = std::max(most, std::abs(off.back()));
  }
  const float edge = std::max({0.1f * (high - low), 0.01f * high, 1e-30f});
  const GraphFrame light = begin_graph(8, low - edge, high + edge, length_m);
  draw_curve(light, plot.at_m, plot.shown, kBlue);
  draw_curve(light, plot.at_m, plot.exact, kSeen);
  end_graph(light, plot.unit);
  const GraphFrame error = begin_graph(4, -1.1f * most, 1.1f * most, length_m);
  draw_curve(error, plot.at_m, off, kRed);
  end_graph(error, plot.unit);
  ImGui::TextUnformatted("exact: white");
  ImGui::SameLine();
  ImGui::TextColored(ImGui::ColorConvertU32ToFloat4(kBlue), "as shown");
  ImGui::SameLine();
  ImGui::TextColored(ImGui::ColorConvertU32ToFloat4(kRed), "shown minus exact");
  lay_out_lines(plot.lines);
}

/// From the plane of a source to its tile.
struct TileFit {
  ImVec2 middle;
  std::array<float, 2> centre{};
  float pixels_per_m = 1;

  std::vector<ImVec2> points(const FlatPolygon& polygon) const {
    std::vector<ImVec2> out;
    for (const auto& p : polygon)
      out.push_back({middle.x + (p[0] - centre[0]) * pixels_per_m,
                     middle.y - (p[1] - centre[1]) * pixels_per_m});
    return out;
  }
};

TileFit fit_tile(const FlatPolygon& outline, ImVec2 from, ImVec2 extent) {
  std::array<float, 2> low{INFINITY, INFINITY}, high{-INFINITY, -INFINITY};
  for (const auto& p : outline)
    for (size_t k = 0; k < 2; ++k)
      low[k] = std::min(low[k], p[k]), high[k] = std::max(high[k], p[k]);
  TileFit out;
  out.middle = {from.x + extent.x / 2, from.y + extent.y / 2};
  out.centre = {(low[0] + high[0]) / 2, (low[1] + high[1]) / 2};
  out.pixels_per_m = 0.92f * std::min(extent.x / std::max(high[0] - low[0], 1e-9f),
                                      extent.y / std::max(high[1] - low[1], 1e-9f));
  return out;
}

void fill_polygon(const TileFit& fit, const FlatPolygon& polygon, ImU32 color) {
  const std::vector<ImVec2> points = fit.points(polygon);
  if (points.size() > 2)
    ImGui::GetWindowDrawList()->AddConvexPolyFilled(points.data(), int(points.size()), color);
}

/// Seen parts are white, hidden ones violet, parts under the horizon grey.
void lay_out_source(const SourcePicture& source) {
  const float size = ImGui::GetFontSize();
  const ImVec2 from = ImGui::GetCursorScreenPos(), extent{size * 12, size * 6};
  ImDrawList& list = *ImGui::GetWindowDrawList();
  list.AddRectFilled(from, {from.x + extent.x, from.y + extent.y}, kGround);
  const TileFit fit = fit_tile(source.outline, from, extent);
  fill_polygon(fit, source.outline, kHorizon);
  fill_polygon(fit, source.above, kViolet);
  for (const FlatPolygon& part : source.visible) fill_polygon(fit, part, kSeen);
  for (const FlatPolygon& part : source.visible) {
    const std::vector<ImVec2> points = fit.points(part);
    list.AddPolyline(points.data(), int(points.size()), IM_COL32(60, 160, 80, 255),
                     ImDrawFlags_Closed, 1);
  }
  ImGui::Dummy(extent);
  lay_out_lines(source.lines);
}

void lay_out_tools(SelectionPanel& panel) {
  for (size_t i = 0; i < panel.tools.size(); ++i) {
    if (i % 2 == 1) ImGui::SameLine(ImGui::GetFontSize() * 15.5f);
    ImGui::RadioButton(panel.tools[i].c_str(), &panel.tool, int(i));
  }
  panel.asks_for_graph = ImGui::Button("graph across it (g)");
  ImGui::SameLine();
  panel.asks_for_nothing = ImGui::Button("nothing (esc)");
  panel.step = -1;
  if (!panel.can_step) return;
  constexpr const char* kSteps[] = {"up (p)", "down (c)", "next link (n)"};
  for (int i = 0; i < 3; ++i) {
    if (i > 0) ImGui::SameLine();
    if (ImGui::Button(kSteps[i])) panel.step = i;
  }
}

}  // namespace

void lay_out_selection(SelectionPanel& panel) {
  const ImVec2 screen = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({screen.x - 10, 10}, ImGuiCond_FirstUseEver, {1, 0});
  const float width = ImGui::GetFontSize() * 34;
  ImGui::SetNextWindowSizeConstraints({width, 0}, {width, screen.y - 20});
  ImGui::Begin("select and probe", nullptr, ImGuiWindowFlags_AlwaysAutoResize);
  lay_out_tools(panel);
  if (!panel.said.empty()) lay_out_lines({panel.said});
  if (!panel.selected.empty()) ImGui::Separator();
  lay_out_lines(panel.selected);
  if (panel.curve) {
    ImGui::Separator();
    lay_out_curve(*panel.curve);
    ImGui::SetNextItemWidth(ImGui::GetFontSize() * 10);
    for (size_t i = 0; i < panel.graph_shows.size(); ++i) {
      constexpr const char* kInSpace[] = {"exact", "as shown", "difference"};
      ImGui::Checkbox(kInSpace[i], &panel.graph_shows[i]);
      ImGui::SameLine();
    }
    ImGui::SliderFloat("height in space", &panel.graph_height, 0.01f, 10, "%.2f of its length",
                       ImGuiSliderFlags_Logarithmic);
  }
  if (!panel.light.empty()) ImGui::Separator();
  lay_out_lines(panel.light);
  for (const SourcePicture& source : panel.sources) {
    ImGui::Separator();
    lay_out_source(source);
  }
  if (!panel.left_out.empty()) lay_out_lines({panel.left_out});
  ImGui::End();
}

}  // namespace luxel::view_window
