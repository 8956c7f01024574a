// Text in the panel that may quote a file or a user: one line each, as short_message() shows it. A
// name of megabytes would be laid out letter by letter in every frame.
#pragma once

#include <imgui.h>

#include <string>

#include "luxel/base/shown_text.h"

namespace luxel::view_window {

inline void lay_out_text(const std::string& text) {
  ImGui::TextUnformatted(short_message(text).c_str());
}

/// True when it was clicked.
inline bool lay_out_line_of_list(const std::string& name, bool is_selected) {
  return ImGui::Selectable(short_message(name).c_str(), is_selected);
}

inline void lay_out_progress(float share, const std::string& text) {
  ImGui::ProgressBar(share, {ImGui::GetFontSize() * 18, 0}, short_message(text).c_str());
}

}  // namespace luxel::view_window
