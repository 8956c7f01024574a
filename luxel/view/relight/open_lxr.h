// An .lxr file, read so that its lamps can be moved.
#pragma once

#include <filesystem>
#include <memory>

#include "luxel/base/result.h"
#include "luxel/view/read_scene.h"
#include "luxel/view/relight/relit_light.h"

namespace luxel::view {

/// A scene that is relit as its lamps change.
struct OpenedLxr {
  std::filesystem::path file;
  std::shared_ptr<const ReadScene> read;  ///< the file's, under its background
  RelitLight light;
  Lamps lamps;  ///< as baked
};

/// True: the file's name is that of an .lxr file.
bool is_lxr(const std::filesystem::path& file);

/// The light of the file's lamps is there at once. Errors: those of files; a file without texels to
/// light or without its scene.
Result<OpenedLxr> open_lxr(const std::filesystem::path& file);

/// Opens data that a file of that name holds, or will hold. `before`: the scene looked at so far,
/// whose view stays; null: the view is that of `luxel render`. Errors: as above.
Result<OpenedLxr> opened_lxr(matrix::RelightData data, const std::filesystem::path& file,
                             const ReadScene* before);

}  // namespace luxel::view
