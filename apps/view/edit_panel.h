// Panel of a scene that is edited, with the fields that the user may change.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "apps/view/lamp_panel.h"

namespace luxel::view_window {

/// An item to choose: its name, and its number in the scene.
struct EditChoice {
  std::string name;
  int number = 0;
};

/// Numbers of an instance. All may be changed.
struct PlaceLines {
  std::array<double, 3> place{};  ///< in the world of the file [m]
  std::array<float, 3> angles_deg{}, scale{};
  friend bool operator==(const PlaceLines&, const PlaceLines&) = default;
};

/// A material. All but its unit may be changed.
struct MaterialLine {
  std::array<float, 3> reflectance{};  ///< display values
  float metallic = 0;
  bool has_metal = true;  ///< it can have some
  std::string reflects;   ///< in percent, in words
  LampLine glow;
  bool has_texture = false;  ///< the reflectance is a factor of it
  friend bool operator==(const MaterialLine&, const MaterialLine&) = default;
};

struct EditPanel {
  std::span<const char* const> tools;
  int tool = 0;  ///< changed
  bool can_undo = false, can_redo = false;
  bool asks_to_undo = false, asks_to_redo = false, asks_to_save = false;  ///< changed
  std::string save_state;                                                 ///< while it is saved

  std::span<const EditChoice> instances, materials;
  std::vector<EditChoice> lamps;
  int instance = -1, material = -1, lamp = -1;  ///< changed: numbers of what is selected; -1: none
  PlaceLines place;                             ///< of the instance
  MaterialLine look;                            ///< of the material
  LampLine light;                               ///< of the lamp
  std::array<char, 96> sun{};  ///< changed: where the lamp stands as a sun, in words
  bool asks_for_sun = false;   ///< changed: it is to stand there

  bool adds_point = false, adds_spot = false, adds_sun = false;  ///< changed: a lamp more
  bool deletes_lamp = false;                                     ///< changed
  bool is_held = false;  ///< changed: something of it is being dragged or typed into
};

/// Lays itself out in the window of ImGui that is open.
void lay_out_edit(EditPanel& panel);

}  // namespace luxel::view_window
