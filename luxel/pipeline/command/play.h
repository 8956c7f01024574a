// A sequence of pictures of a scene whose lights move: `luxel relight --play`.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "luxel/base/progress.h"
#include "luxel/base/result.h"

namespace luxel::pipeline {

/// Settings of `luxel relight --play`.
struct PlaySettings {
  std::filesystem::path lxr;
  std::filesystem::path script;  ///< a light script (luxel/pipeline/command/light_script.h)
  std::filesystem::path output;  ///< a folder for frame-0000.png, ... and frames.csv
  int threads = 0;               ///< 0: all cores
};

/// A frame's time in the script, and the durations of its steps.
struct FrameTimes {
  double time_s = 0;  ///< in the script
  double direct_ms = 0, bounces_ms = 0, places_ms = 0, draw_ms = 0;
  /// Duration of the relighter's work, without drawing [ms].
  double update_ms() const { return direct_ms + bounces_ms + places_ms; }
};

/// The size of the frames [pixels], and what each took.
struct Played {
  int width = 0, height = 0;
  std::vector<FrameTimes> frames;
};

/// Direct light is drawn per pixel, with a shadow ray for each punctual light; indirect light comes
/// from the relighter. All frames have the exposure that suits the first. Errors: what the files
/// say; a script that names what the scene does not have.
Result<Played> play(const PlaySettings& settings, Progress& progress);

}  // namespace luxel::pipeline
