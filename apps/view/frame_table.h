// A table of the frames of a play: how long each took, and how bright it was.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/view/screen.h"
#include "apps/view/subject.h"
#include "luxel/base/clock.h"

namespace luxel::view_window {

struct FrameTable {
  struct Row {
    float milliseconds = 0;  ///< from the first command to the picture in the window
    double brightness = 0;   ///< the mean of what the screen shows, in [0, 1] of its range
    double samples = 0;      ///< of the light that came last
    bool has_light = false;  ///< false: colours alone, or nothing yet
    view::LightTimes light;  ///< of lamps that move
    double at_s = 0;         ///< when it was in the window, since the first one was
    uint64_t edits = 0;      ///< of the scene, that it shows
  };
  std::vector<Row> rows;
  std::optional<Clock::time_point> first;  ///< when the first frame was in the window
};

/// The frame that was just drawn. Reads it back, which is not counted. Errors: the device is lost.
Status add_row(Screen& screen, float milliseconds, Subject& subject, FrameTable& table);

std::string csv_of(const FrameTable& table);

}  // namespace luxel::view_window
