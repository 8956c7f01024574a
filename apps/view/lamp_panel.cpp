#include "apps/view/lamp_panel.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "apps/view/ui_text.h"

namespace luxel::view_window {
namespace {

constexpr ImU32 kStageColors[] = {IM_COL32(230, 190, 80, 255),  IM_COL32(220, 110, 80, 255),
                                  IM_COL32(180, 120, 200, 255), IM_COL32(110, 130, 220, 255),
                                  IM_COL32(90, 190, 210, 255),  IM_COL32(120, 190, 110, 255)};
constexpr size_t kGraphFrames = 120, kMeanFrames = 30;

/// Names to choose from; what is chosen can be changed.
void lay_out_lines(std::vector<LampLine>& lines, int& selected) {
  for (size_t i = 0; i < lines.size(); ++i) {
    ImGui::PushID(int(i));  // names need not differ
    const std::string name = lines[i].name + (lines[i].is_on ? "" : " (off)");
    const bool is_selected = selected == int(i);
    if (lay_out_line_of_list(name, is_selected)) selected = is_selected ? -1 : int(i);
    if (is_selected) {
      ImGui::Indent();
      lay_out_line(lines[i]);
      ImGui::Unindent();
    }
    ImGui::PopID();
  }
}

float sum_of(const StageTimes& times) { return std::accumulate(times.begin(), times.end(), 0.0f); }

/// Each picture a column of what its stages took, the newest at the right end.
void draw_graph(const std::vector<StageTimes>& history) {
  const float size = ImGui::GetFontSize();
  const ImVec2 from = ImGui::GetCursorScreenPos(), extent{size * 18, size * 5};
  ImDrawList& list = *ImGui::GetWindowDrawList();
  list.AddRectFilled(from, {from.x + extent.x, from.y + extent.y},
                     ImGui::GetColorU32(ImGuiCol_FrameBg));
  float most = 1e-3f;
  for (const StageTimes& times : history) most = std::max(most, sum_of(times));
  const float column = extent.x / float(kGraphFrames);
  for (size_t k = 0; k < history.size(); ++k) {
    const float x = from.x + extent.x - column * float(history.size() - k);
    float y = from.y + extent.y;
    for (size_t stage = 0; stage < history[k].size(); ++stage) {
      const float height = history[k][stage] / most * extent.y;
      list.AddRectFilled({x, y - height}, {x + column, y}, kStageColors[stage]);
      y -= height;
    }
  }
  char label[32];
  snprintf(label, sizeof(label), "%.1f ms", double(most));
  list.AddText({from.x + 3, from.y + 1}, ImGui::GetColorU32(ImGuiCol_Text), label);
  ImGui::Dummy(extent);
}

/// The mean of what a stage took in those of the last pictures that had it.
float mean_of(const std::vector<StageTimes>& history, size_t stage) {
  float sum = 0;
  int count = 0;
  for (size_t k = history.size() - std::min(history.size(), kMeanFrames); k < history.size(); ++k)
    sum += history[k][stage], count += history[k][stage] > 0;
  return sum / float(std::max(count, 1));
}

/// The means of the last pictures, and how many a second would have while lamps move.
void lay_out_times(const std::vector<StageTimes>& history) {
  if (history.empty()) return;
  StageTimes mean{};
  for (size_t stage = 0; stage < mean.size(); ++stage) mean[stage] = mean_of(history, stage);
  draw_graph(history);
  for (size_t stage = 0; stage < mean.size(); ++stage) {
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const float size = ImGui::GetFontSize();
    ImGui::GetWindowDrawList()->AddRectFilled(
        {at.x, at.y + 0.2f * size}, {at.x + 0.6f * size, at.y + 0.8f * size}, kStageColors[stage]);
    ImGui::SetCursorPosX(ImGui::GetCursorPosX() + size);
    ImGui::Text("%s: %.2f ms", kStages[stage], double(mean[stage]));
  }
  ImGui::Text("%.0f pictures/s", 1000 / std::max(1e-3, double(sum_of(mean))));
}

void lay_out_buttons(LampPanel& panel) {
  panel.asks_to_save = ImGui::Button("save lamps");
  ImGui::SameLine();
  panel.asks_for_lxr = ImGui::Button("save .lxr");
  panel.asks_to_check = ImGui::Button(panel.checked < 0 ? "compare with paths" : "stop comparing");
  if (panel.checked >= 0) ImGui::ProgressBar(panel.checked, {ImGui::GetFontSize() * 18, 0});
  if (panel.found.empty()) return;
  ImGui::PushTextWrapPos(ImGui::GetFontSize() * 20);
  lay_out_text(panel.found);
  ImGui::PopTextWrapPos();
}

}  // namespace

void lay_out_place(std::array<double, 3>& place) {
  constexpr double kMostInALine_m = 1e4;
  const auto is_long = [](double x) { return std::abs(x) >= kMostInALine_m; };
  if (std::ranges::any_of(place, is_long)) {
    for (size_t k = 0; k < 3; ++k) {
      const std::string label = std::string("place ") + "xyz"[k];
      ImGui::DragScalar(label.c_str(), ImGuiDataType_Double, &place[k], 0.01f, nullptr, nullptr,
                        "%.3f m");
    }
    return;
  }
  ImGui::DragScalarN("place", ImGuiDataType_Double, place.data(), 3, 0.01f, nullptr, nullptr,
                     "%.3f m");
}

void lay_out_line(LampLine& line) {
  ImGui::Checkbox("on", &line.is_on);
  ImGui::SameLine();
  ImGui::ColorEdit3("colour", line.color.data(), ImGuiColorEditFlags_NoInputs);
  ImGui::DragFloat("strength", &line.strength, std::max(1e-6f, 0.01f * line.strength), 0, 1e12f,
                   ("%.4g " + line.unit).c_str());
  if (line.has_place) lay_out_place(line.place);
  if (line.has_direction) ImGui::DragFloat3("direction", line.direction.data(), 0.01f, -1, 1);
  if (line.has_cone) {
    ImGui::DragFloat("cone", &line.cone_deg, 0.2f, 0.1f, 90, "%.1f deg");
    ImGui::DragFloat("inner cone", &line.inner_cone_deg, 0.2f, 0, line.cone_deg, "%.1f deg");
  }
  if (line.has_disc) ImGui::DragFloat("disc", &line.disc_deg, 0.02f, 0, 90, "%.2f deg");
}

void lay_out_lamps(LampPanel& panel) {
  ImGui::PushItemWidth(ImGui::GetFontSize() * 12);
  ImGui::SetNextItemOpen(true, ImGuiCond_Once);
  if (ImGui::CollapsingHeader("lamps")) {
    lay_out_lines(panel.lamps, panel.selected);
    panel.adds_point = ImGui::Button("+ point");
    ImGui::SameLine();
    panel.adds_spot = ImGui::Button("+ spot");
    ImGui::SameLine();
    panel.adds_sun = ImGui::Button("+ sun");
  }
  if (!panel.glows.empty() && ImGui::CollapsingHeader("emissive materials"))
    lay_out_lines(panel.glows, panel.selected_glow);
  lay_out_buttons(panel);
  ImGui::SetNextItemOpen(true, ImGuiCond_Once);
  if (ImGui::CollapsingHeader("time")) lay_out_times(panel.history);
  ImGui::PopItemWidth();
}

}  // namespace luxel::view_window
