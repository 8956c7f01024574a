// Panel of lamps, with the fields that the user may change. Dear ImGui draws it.
#pragma once

#include <array>
#include <string>
#include <vector>

namespace luxel::view_window {

/// A lamp, or a material that glows. All but the name and the unit may be changed.
struct LampLine {
  std::string name, unit;
  bool is_on = true;
  std::array<float, 3> color{1, 1, 1};  ///< display values, the largest one 1
  float strength = 1;                   ///< of the largest [unit]
  bool has_place = false, has_direction = false;
  std::array<double, 3> place{};  ///< in the world of the file [m]
  std::array<float, 3> direction{};
  bool has_cone = false, has_disc = false;
  float cone_deg = 0, inner_cone_deg = 0;  ///< of a spot: half the angle of its light
  float disc_deg = 0;                      ///< of a sun: the angle of its disc
  friend bool operator==(const LampLine&, const LampLine&) = default;
};

/// Stages of a picture's light. StageTimes has a time for each, in this order [ms].
inline constexpr const char* kStages[] = {"lamps at patches", "bounces",     "texels",
                                          "map to device",    "shadow maps", "picture"};
using StageTimes = std::array<float, 6>;

struct LampPanel {
  std::vector<LampLine> lamps, glows;
  int selected = -1, selected_glow = -1;                         ///< may be changed; -1: none
  bool adds_point = false, adds_spot = false, adds_sun = false;  ///< changed: a lamp more
  /// Against the path tracer: how far that has come, -1 where nothing is compared; and what it
  /// found.
  float checked = -1;
  std::string found;
  bool asks_to_save = false, asks_for_lxr = false;  ///< changed: a script, an .lxr file
  bool asks_to_check = false;                       ///< changed; stops it, too
  std::vector<StageTimes> history;                  ///< of the last pictures, the newest last
};

/// Three numbers of a place [m].
void lay_out_place(std::array<double, 3>& place);
/// Both lay themselves out in the window of ImGui that is open.
void lay_out_line(LampLine& line);
void lay_out_lamps(LampPanel& panel);

}  // namespace luxel::view_window
