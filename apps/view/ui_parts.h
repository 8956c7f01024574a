// The part of the panel that says what of the light is shown, and whether probes are. It knows
// nothing of luxel: ui.h says why.
#pragma once

#include <span>
#include <string>

namespace luxel::view_window {

/// The parts of light that are shown. The user may change the fields that say so.
struct PartsPanel {
  bool has_parts = false;              ///< light can be told apart here
  std::span<const char* const> parts;  ///< those that have a name
  int part = 0;                        ///< changed: -1: none of them
  int bounces = 0, most_bounces = 0;   ///< changed: reflections that light has behind it, at most
  bool is_one = false;                 ///< changed: so many and no fewer
  std::string words;                   ///< on what is shown
  bool has_probes = false;             ///< there may be probes
  bool shows_probes = false;           ///< changed
};

/// Between Begin and End of the panel.
void lay_out_parts(PartsPanel& parts);

}  // namespace luxel::view_window
