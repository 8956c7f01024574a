#include "apps/view/edit_panel.h"

#include <imgui.h>

#include "apps/view/ui_text.h"

namespace luxel::view_window {
namespace {

/// A list to choose from, of names that need not differ.
void lay_out_choices(const char* label, std::span<const EditChoice> choices, int& chosen) {
  std::string now = "none";
  for (const EditChoice& choice : choices)
    if (choice.number == chosen) now = short_message(choice.name);
  if (!ImGui::BeginCombo(label, now.c_str())) return;
  if (ImGui::Selectable("none", chosen < 0)) chosen = -1;
  ImGuiListClipper clipper;
  clipper.Begin(int(choices.size()));
  while (clipper.Step())
    for (int i = clipper.DisplayStart; i < clipper.DisplayEnd; ++i) {
      ImGui::PushID(i);
      const EditChoice& choice = choices[size_t(i)];
      if (lay_out_line_of_list(choice.name, choice.number == chosen)) chosen = choice.number;
      ImGui::PopID();
    }
  ImGui::EndCombo();
}

void lay_out_instance(EditPanel& panel) {
  for (size_t i = 0; i < panel.tools.size(); ++i) {
    if (i > 0) ImGui::SameLine();
    ImGui::RadioButton(panel.tools[i], &panel.tool, int(i));
  }
  lay_out_place(panel.place.place);
  ImGui::DragFloat3("angles", panel.place.angles_deg.data(), 0.5f, 0, 0, "%.1f deg");
  ImGui::DragFloat3("scale", panel.place.scale.data(), 0.01f, 0, 0, "%.3f");
}

void lay_out_material(EditPanel& panel) {
  MaterialLine& look = panel.look;
  ImGui::ColorEdit3(look.has_texture ? "tint" : "reflectance", look.reflectance.data(),
                    ImGuiColorEditFlags_Float);
  lay_out_text(look.reflects);
  if (look.has_metal)
    ImGui::SliderFloat("metal", &look.metallic, 0, 1, "%.2f", ImGuiSliderFlags_AlwaysClamp);
  ImGui::ColorEdit3("glow", look.glow.color.data(), ImGuiColorEditFlags_NoInputs);
  ImGui::SameLine();
  ImGui::SetNextItemWidth(ImGui::GetFontSize() * 9);
  ImGui::DragFloat("##strength", &look.glow.strength, 0.01f * look.glow.strength + 1e-3f, 0, 1e12f,
                   ("%.4g " + look.glow.unit).c_str());
}

void lay_out_lamp(EditPanel& panel) {
  lay_out_line(panel.light);
  if (panel.light.has_disc) {
    ImGui::InputTextWithHint("##sun", "azimuth,elevation", panel.sun.data(), panel.sun.size());
    ImGui::SameLine();
    panel.asks_for_sun = ImGui::Button("move the sun");
    ImGui::TextUnformatted("or 2026-06-21T15:30+02:00,48.9,2.4:\ntime, latitude, longitude");
  }
  panel.deletes_lamp = ImGui::Button("delete");
}

void lay_out_new_lamps(EditPanel& panel) {
  panel.adds_point = ImGui::Button("+ point");
  ImGui::SameLine();
  panel.adds_spot = ImGui::Button("+ spot");
  ImGui::SameLine();
  panel.adds_sun = ImGui::Button("+ sun");
}

bool lay_out_button(const char* label, bool is_enabled) {
  ImGui::BeginDisabled(!is_enabled);
  const bool out = ImGui::Button(label);
  ImGui::EndDisabled();
  return out;
}

void lay_out_steps(EditPanel& panel) {
  panel.asks_to_undo = lay_out_button("undo", panel.can_undo);
  ImGui::SameLine();
  panel.asks_to_redo = lay_out_button("redo", panel.can_redo);
  ImGui::SameLine();
  panel.asks_to_save = lay_out_button("save scene", panel.save_state.empty());
  if (!panel.save_state.empty()) lay_out_text(panel.save_state);
}

}  // namespace

void lay_out_edit(EditPanel& panel) {
  ImGui::SetNextItemOpen(true, ImGuiCond_Once);
  if (!ImGui::CollapsingHeader("edit")) return;
  ImGui::PushID("edit");
  ImGui::PushItemWidth(ImGui::GetFontSize() * 14);
  lay_out_steps(panel);
  const int instance = panel.instance, material = panel.material, lamp = panel.lamp;
  lay_out_choices("object", panel.instances, panel.instance);
  if (instance >= 0 && panel.instance == instance) lay_out_instance(panel);
  lay_out_choices("material", panel.materials, panel.material);
  if (material >= 0 && panel.material == material) lay_out_material(panel);
  lay_out_choices("lamp", panel.lamps, panel.lamp);
  if (lamp >= 0 && panel.lamp == lamp) lay_out_lamp(panel);
  lay_out_new_lamps(panel);
  panel.is_held = ImGui::IsAnyItemActive();
  ImGui::PopItemWidth();
  ImGui::PopID();
}

}  // namespace luxel::view_window
