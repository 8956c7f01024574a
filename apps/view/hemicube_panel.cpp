#include "apps/view/hemicube_panel.h"

#include <imgui.h>

#include <bit>

#include "apps/view/ui_text.h"

namespace luxel::view_window {
namespace {

void lay_out_techniques(HemicubePanel& panel) {
  ImGui::SetNextItemWidth(ImGui::GetFontSize() * 14);
  if (!ImGui::BeginCombo("technique", panel.techniques[size_t(panel.technique)])) return;
  for (int i = 0; i < int(panel.techniques.size()); ++i)
    if (ImGui::Selectable(panel.techniques[size_t(i)], i == panel.technique)) panel.technique = i;
  ImGui::EndCombo();
}

/// A slider of powers of two; other sizes, which plays may ask for, stay until it is moved.
void lay_out_size(HemicubePanel& panel) {
  int power = std::bit_width(unsigned(panel.size)) - 1;
  const int most = std::bit_width(unsigned(panel.most_pixels)) - 1;
  ImGui::SetNextItemWidth(ImGui::GetFontSize() * 10);
  const std::string text = std::to_string(panel.size) + " pixels";
  if (ImGui::SliderInt("hemicube", &power, 1, most, text.c_str())) panel.size = 1 << power;
}

void lay_out_sizes(const HemicubePanel& panel) {
  if (panel.sizes.empty() || !ImGui::BeginTable("sizes", 4)) return;
  const std::string light = "E " + panel.unit;
  for (const char* head : {"pixels", "sum's error", "wrong", light.c_str()})
    ImGui::TableSetupColumn(head);
  ImGui::TableHeadersRow();
  for (const SizeLine& line : panel.sizes) {
    ImGui::TableNextColumn();
    ImGui::Text("%d", line.pixels);
    ImGui::TableNextColumn();
    line.wrong < 0 ? ImGui::TextUnformatted("-") : ImGui::Text("%+.5f", double(line.sum_error));
    ImGui::TableNextColumn();
    line.wrong < 0 ? ImGui::TextUnformatted("-") : ImGui::Text("%.3f %%", double(100 * line.wrong));
    ImGui::TableNextColumn();
    ImGui::Text("%.5g", double(line.irradiance));
  }
  ImGui::EndTable();
}

void lay_out_element(HemicubePanel& panel) {
  if (!panel.has_element) {
    ImGui::TextUnformatted("click a surface to see what its vertex sees");
    return;
  }
  lay_out_size(panel);
  ImGui::RadioButton("triangles", &panel.faces, 0);
  ImGui::SameLine();
  ImGui::RadioButton("light", &panel.faces, 1);
  ImGui::SameLine();
  ImGui::RadioButton("no faces", &panel.faces, 2);
  for (const std::string& line : panel.lines) lay_out_text(line);
  if (!panel.histogram.empty())
    ImGui::PlotHistogram("##row", panel.histogram.data(), int(panel.histogram.size()), 0, nullptr,
                         0, FLT_MAX, {ImGui::GetFontSize() * 18, ImGui::GetFontSize() * 4});
  lay_out_sizes(panel);
}

}  // namespace

void lay_out_hemicube(HemicubePanel& panel) {
  lay_out_progress(panel.share, panel.state);
  panel.asks_to_stop = panel.can_stop && ImGui::Button("stop");
  panel.asks_to_go_on = panel.can_go_on && ImGui::Button("go on");
  lay_out_techniques(panel);
  lay_out_element(panel);
  ImGui::Separator();
}

}  // namespace luxel::view_window
