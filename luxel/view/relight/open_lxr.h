// An .lxr file, read so that its lamps can be moved.
#pragma once

#include <filesystem>
#include <memory>

#include "luxel/base/result.h"
#include "luxel/view/frame.h"
#include "luxel/view/relight/relit_light.h"

namespace luxel::view {

/// A scene that is relit as its lamps change.
struct OpenedLxr {
  scene::Scene scene;  ///< of the file, under its background
  RelitLight light;
  Lamps lamps;  ///< as baked
  Frame first;  ///< what is shown first
};

/// The size of the first picture, where none is asked for.
inline constexpr int kLxrWidth = 960, kLxrHeight = 720;

/// The light of the file's lamps is there at once. Errors: those of files; a file without texels to
/// light or without its scene.
Result<std::unique_ptr<OpenedLxr>> open_lxr(const std::filesystem::path& file);

}  // namespace luxel::view
