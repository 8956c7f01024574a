#include "apps/view/ui_parts.h"

#include <imgui.h>

namespace luxel::view_window {

void lay_out_parts(PartsPanel& parts) {
  if (parts.has_probes) ImGui::Checkbox("probes as balls (B)", &parts.shows_probes);
  if (!parts.has_parts || !ImGui::CollapsingHeader("parts of the light")) return;
  for (size_t i = 0; i < parts.parts.size(); ++i) {
    if (i > 0) ImGui::SameLine();
    ImGui::RadioButton(parts.parts[i], &parts.part, int(i));
  }
  ImGui::SetNextItemWidth(ImGui::GetFontSize() * 10);
  if (ImGui::SliderInt("bounces", &parts.bounces, 0, parts.most_bounces)) parts.part = -1;
  if (ImGui::Checkbox("only this bounce", &parts.is_one)) parts.part = -1;
  ImGui::TextUnformatted(parts.words.c_str());
}

}  // namespace luxel::view_window
