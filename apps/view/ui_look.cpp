#include "apps/view/ui_look.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "luxel/base/shown_text.h"

namespace luxel::view_window {
namespace {

constexpr int kTicks = 5;

/// Where in the scale a value lies: 0 at its low end, 1 at its high one.
float place_of(const LookPanel& look, float value) {
  if (look.is_logarithmic)
    return value > look.low ? std::log(value / look.low) / std::log(look.high / look.low) : 0;
  return (value - look.low) / (look.high - look.low);
}

float value_at(const LookPanel& look, float place) {
  if (look.is_logarithmic) return look.low * std::pow(look.high / look.low, place);
  return look.low + (look.high - look.low) * place;
}

/// A bar of all colours, its values under it, and a mark at the value under the pointer.
void lay_out_legend(const LookPanel& look) {
  const float width = ImGui::GetFontSize() * 17, height = ImGui::GetFontSize();
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  const auto count = float(look.colors.size());
  for (size_t i = 0; i < look.colors.size(); ++i) {
    const float from = corner.x + width * float(i) / count;
    const float to = corner.x + width * float(i + 1) / count;
    draw.AddRectFilled({from, corner.y}, {to, corner.y + height},
                       look.colors[i] | uint32_t(255) << IM_COL32_A_SHIFT);
  }
  const uint32_t ink = ImGui::GetColorU32(ImGuiCol_Text);
  if (look.pointed >= 0) {
    const float x = corner.x + width * std::clamp(place_of(look, look.pointed), 0.0f, 1.0f);
    draw.AddTriangleFilled({x, corner.y + 0.6f * height}, {x + 4, corner.y + height + 2},
                           {x - 4, corner.y + height + 2}, ink);
  }
  for (int i = 0; i < kTicks; ++i) {
    const float place = float(i) / (kTicks - 1);
    char text[32];
    std::snprintf(text, sizeof text, "%.3g", double(value_at(look, place)));
    const float room = width - ImGui::CalcTextSize(text).x;
    const float wanted = width * place - ImGui::CalcTextSize(text).x / 2;
    draw.AddText({corner.x + std::clamp(wanted, 0.0f, room), corner.y + height + 2}, ink, text);
  }
  ImGui::Dummy({width, height + ImGui::GetFontSize() + 6});
}

void lay_out_range(LookPanel& look) {
  float range[2] = {look.low, look.high};
  ImGui::SetNextItemWidth(ImGui::GetFontSize() * 11);
  const float speed = std::max(look.high - look.low, 1e-6f) / 200;
  if (ImGui::DragFloat2("range", range, speed, 0, 1e9f, "%.3g") && range[1] > range[0])
    look.low = range[0], look.high = range[1];
  ImGui::Checkbox("logarithmic", &look.is_logarithmic);
  ImGui::SameLine();
  if (ImGui::Button("range of the bake")) look.asks_for_own_scale = true;
}

void lay_out_choice(const char* label, std::span<const char* const> names, const char* none,
                    int& chosen) {
  ImGui::SetNextItemWidth(ImGui::GetFontSize() * 17);
  if (!ImGui::BeginCombo(label, chosen < 0 ? none : names[size_t(chosen)])) return;
  for (size_t i = 0; i < names.size(); ++i)
    if (ImGui::Selectable(names[i], chosen == int(i))) chosen = int(i);
  ImGui::EndCombo();
}

/// A dimmer and a colour for each layer. "only" puts all others out.
void lay_out_layers(LookPanel& look) {
  look.asks_for_layers = ImGui::CollapsingHeader("layers of light");
  if (!look.asks_for_layers) return;
  for (size_t i = 0; i < look.layers.size(); ++i) {
    LayerLine& line = look.layers[i];
    ImGui::PushID(int(i));
    ImGui::ColorEdit3("##color", line.color,
                      ImGuiColorEditFlags_NoInputs | ImGuiColorEditFlags_Float);
    ImGui::SameLine();
    if (ImGui::SmallButton("only"))
      for (LayerLine& other : look.layers) other.dimmer = &other == &line ? 1 : 0;
    ImGui::SameLine();
    ImGui::SetNextItemWidth(ImGui::GetFontSize() * 6);
    ImGui::SliderFloat(short_message(line.words).c_str(), &line.dimmer, 0, 2, "%.2f");
    ImGui::PopID();
  }
  if (ImGui::Button("as baked"))
    for (LayerLine& line : look.layers) line = {line.layer, line.words, 1, {1, 1, 1}};
}

/// Pixels by their luminance; the line marks the luminance that the exposure brings to white.
void lay_out_histogram(LookPanel& look) {
  look.asks_for_histogram = ImGui::CollapsingHeader("histogram of luminance");
  if (!look.asks_for_histogram || look.histogram.empty()) return;
  const ImVec2 size{ImGui::GetFontSize() * 17, ImGui::GetFontSize() * 5};
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  const float most =
      std::max(*std::max_element(look.histogram.begin(), look.histogram.end()), 1e-6f);
  ImGui::PlotHistogram("##histogram", look.histogram.data(), int(look.histogram.size()), 0, nullptr,
                       0, most, size);
  const float x = corner.x + size.x * look.white_place;
  ImGui::GetWindowDrawList()->AddLine({x, corner.y}, {x, corner.y + size.y},
                                      ImGui::GetColorU32(ImGuiCol_Text));
  ImGui::TextUnformatted(look.histogram_words.c_str());
}

void lay_out_beside(LookPanel& look) {
  for (size_t i = 0; i < look.beside_modes.size(); ++i) {
    if (i > 0) ImGui::SameLine();
    ImGui::RadioButton(look.beside_modes[i], &look.beside_mode, int(i));
  }
  if (look.flip >= 0) ImGui::Text("mean FLIP %.4f", double(look.flip));
}

}  // namespace

void lay_out_look(LookPanel& look) {
  lay_out_beside(look);
  lay_out_histogram(look);
  if (look.has_layers) lay_out_layers(look);
  if (!look.kinds.empty()) lay_out_choice("##look", look.kinds, "look into the bake", look.kind);
  if (look.kind < 0 && !look.has_scale) return;
  if (!look.channels.empty()) lay_out_choice("##channel", look.channels, "", look.channel);
  if (look.has_scale) {
    const char* unit = look.unit.c_str();
    if (look.pointed >= 0)
      ImGui::Text("%s: %.4g %s at the pointer", look.title.c_str(), double(look.pointed), unit);
    else
      ImGui::Text("%s%s%s", look.title.c_str(), look.unit.empty() ? "" : ", in ", unit);
    lay_out_legend(look);
  }
  if (look.can_scale) lay_out_range(look);
  if (!look.note.empty()) ImGui::TextUnformatted(look.note.c_str());
}

}  // namespace luxel::view_window
