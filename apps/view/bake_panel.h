// The part of the panel that is about a bake. It knows nothing of luxel: ui.h says why.
#pragma once

#include <string>
#include <vector>

namespace luxel::view_window {

/// Lines and buttons of a bake that is being made.
struct BakeLines {
  std::string state;  ///< the stage, or how it ended
  float share = 0;    ///< of the stage that is done
  std::vector<std::string> lines;
  std::string note;  ///< what the bake has told last
  bool can_stop = false, can_go_on = false, can_save = false;
  bool asks_to_stop = false, asks_to_go_on = false, asks_to_save = false;  ///< changed
};

}  // namespace luxel::view_window
