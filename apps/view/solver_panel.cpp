#include "apps/view/solver_panel.h"

#include <imgui.h>

#include "apps/view/ui_text.h"

namespace luxel::view_window {
namespace {

constexpr float kColumn = 12;  ///< where the second of two begins [letters' heights]

void lay_out_number(NumberLine& line) {
  const ImGuiSliderFlags curve = line.is_logarithmic ? ImGuiSliderFlags_Logarithmic : 0;
  if (!line.is_whole) {
    ImGui::SliderFloat(line.words.c_str(), &line.value, line.low, line.high, "%.3g", curve);
    return;
  }
  int whole = int(line.value);
  if (ImGui::SliderInt(line.words.c_str(), &whole, int(line.low), int(line.high), "%d", curve))
    line.value = float(whole);
}

void lay_out_work(SolverPanel& panel) {
  lay_out_progress(panel.share, panel.state);
  for (const std::string& line : panel.lines) lay_out_text(line);
  panel.asked = -1;
  for (size_t i = 0; i < panel.asks.size(); ++i) {
    if (i % 2 == 1) ImGui::SameLine(ImGui::GetFontSize() * kColumn);
    if (ImGui::Button(panel.asks[i].c_str())) panel.asked = int(i);
  }
  panel.asks_to_stop = false;
  if (!panel.is_solving) return;
  ImGui::SameLine(ImGui::GetFontSize() * kColumn);
  panel.asks_to_stop = ImGui::Button("stop (space)");
}

}  // namespace

void lay_out_solver(SolverPanel& panel) {
  lay_out_work(panel);
  ImGui::Separator();
  for (size_t i = 0; i < panel.kinds.size(); ++i)
    ImGui::RadioButton(panel.kinds[i].c_str(), &panel.kind, int(i));
  if (!panel.note.empty()) lay_out_text(panel.note);
  ImGui::Separator();
  for (size_t i = 0; i < panel.over.size(); ++i) {
    if (i % 2 == 1) ImGui::SameLine(ImGui::GetFontSize() * kColumn);
    ImGui::Checkbox(panel.over[i].words.c_str(), &panel.over[i].is_on);
  }
  ImGui::PushItemWidth(ImGui::GetFontSize() * 9);
  for (NumberLine& line : panel.numbers) lay_out_number(line);
  ImGui::PopItemWidth();
  ImGui::Separator();
}

}  // namespace luxel::view_window
