// The part of the panel that looks into a bake. It knows nothing of luxel: ui.h says why.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace luxel::view_window {

/// A layer of light; what the user may change of it.
struct LayerLine {
  std::string layer;    ///< its name
  std::string words;    ///< that, and its share of the light
  float dimmer = 1;     ///< changed
  float color[3] = {};  ///< changed: linear
};

/// Fields for looking into a bake. The user may change those that say so.
struct LookPanel {
  std::span<const char* const> kinds;     ///< what can be shown of a bake
  int kind = -1;                          ///< changed: -1 none of them
  std::span<const char* const> channels;  ///< of light; empty: it does not matter
  int channel = 0;                        ///< changed

  bool has_scale = false;            ///< there are false colours, and a legend of them
  std::string title, unit;           ///< of their values
  std::span<const uint32_t> colors;  ///< from the lowest to the highest, 0xbbggrr
  float low = 0, high = 1;           ///< changed
  bool is_logarithmic = false;       ///< changed
  bool can_scale = false;            ///< the scale may be changed
  bool asks_for_own_scale = false;   ///< changed: the user wants that of the bake
  float pointed = -1;                ///< the value under the pointer; < 0: none

  bool has_layers = false;        ///< there are layers to be asked for
  bool asks_for_layers = false;   ///< changed: their lines are looked at
  std::vector<LayerLine> layers;  ///< changed

  std::span<const char* const> beside_modes;  ///< how a second bake is shown; empty: none is
  int beside_mode = 0;                        ///< changed
  float flip = -1;                            ///< of the two pictures; < 0: not known

  bool asks_for_histogram = false;  ///< changed: it is looked at
  std::vector<float> histogram;     ///< shares of pixels; empty: not known yet
  float white_place = 1;            ///< of what is exposed to 1, in [0, 1] of its width
  std::string histogram_words;      ///< under it

  std::string note;  ///< a line about what is shown
};

/// Between Begin and End of the panel.
void lay_out_look(LookPanel& look);

}  // namespace luxel::view_window
