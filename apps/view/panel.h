// The panel, with the fields that the user may change. It knows nothing of luxel: ui.h says why.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "apps/view/bake_panel.h"
#include "apps/view/edit_panel.h"
#include "apps/view/hemicube_panel.h"
#include "apps/view/lamp_panel.h"
#include "apps/view/relight_panel.h"
#include "apps/view/selection_panel.h"
#include "apps/view/solver_panel.h"
#include "apps/view/ui_look.h"
#include "apps/view/ui_parts.h"

namespace luxel::view_window {

/// A key and what it does.
struct KeyLine {
  const char *key, *does;
};

/// Where the panel lies, and which of its headers are open, by ImGui's numbers.
struct PanelLayout {
  std::optional<std::array<float, 2>> place;
  std::vector<uint32_t> open, closed;
};

/// Fields of the panel. The user may change those that say so.
struct Panel {
  std::string title;       ///< of the scene
  std::string about;       ///< a line under it
  float milliseconds = 0;  ///< of a frame
  int show = 0;            ///< changed: light and colour, light, colour; > 2: look
  LookPanel look;          ///< into the bake
  PartsPanel parts;        ///< of the light
  bool turns = false;      ///< changed: the camera goes round
  float stops = 0;         ///< changed: exposure over the first
  bool keys_open = false;  ///< changed: the list of keys
  std::span<const KeyLine> keys;
  std::span<const std::string> views;     ///< of the scene's cameras
  int view = -1;                          ///< changed: the one that was asked for; -1: none
  std::array<bool, 9> has_bookmark{};     ///< remembered views
  int bookmark = -1;                      ///< changed: the one that was asked for; -1: none
  std::span<const std::string> warnings;  ///< of the bake that is shown
  std::span<const std::string> recent;    ///< what else was looked at
  bool is_empty = false;                  ///< nothing is shown yet
  int opens = -1;                         ///< changed: the one that is to be opened; -1: none
  bool offers_again = false;              ///< what is shown has changed on disk
  bool asks_again = false;                ///< changed: it is to be opened again
  float scale = 1;                        ///< pixels per point of the monitor
  PanelLayout layout;                     ///< changed; what it is at first comes back
  bool is_light = false;                  ///< changed: dark letters on light ground
  std::optional<BakeLines> bake;
  std::optional<RelightLines> relight;
  std::optional<LampPanel> lamps;
  std::optional<EditPanel> edit;
  std::optional<HemicubePanel> hemicube;
  std::optional<SolverPanel> solver;
  std::optional<SelectionPanel> selection;
  std::string message;  ///< what was done last
};

}  // namespace luxel::view_window
