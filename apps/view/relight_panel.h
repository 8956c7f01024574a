// The part of the panel that is about preparing a scene for lamps that move. It knows nothing of
// luxel: ui.h says why.
#pragma once

#include <string>

namespace luxel::view_window {

/// Lines and the button of this preparation.
struct RelightLines {
  std::string stage;  ///< of what goes on; empty: nothing does
  float share = 0;    ///< of the stage that is done
  std::string left;   ///< how long the stage takes yet; empty: not known
  std::string does;   ///< what its button says
  bool asks = false;  ///< changed: the button was pressed
};

}  // namespace luxel::view_window
