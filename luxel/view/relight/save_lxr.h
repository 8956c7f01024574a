// Moved lamps as another .lxr file.
#pragma once

#include <filesystem>
#include <string>

#include "luxel/view/relight/lamps.h"

namespace luxel::view {

/// The data of an .lxr file with the lamps, glows and background of `now`; how light goes from
/// surface to surface stays. Lamps that are off have the intensity 0. The scene in it has the lamps
/// and glows, too. The file's error of light is known for the baked lights only: it is not stated
/// any longer. `baked`: lamps_of() of the data. `name` is for messages. Errors: the scene in it
/// cannot be read.
Result<matrix::RelightData> with_lamps(const matrix::RelightData& data, const Lamps& baked,
                                       const Lamps& now, const std::string& name);

/// The lamps of a file as they are now. `data` outlives the saving.
struct LampsToSave {
  std::filesystem::path file;  ///< that they were read from
  const matrix::RelightData* data = nullptr;
  Lamps baked, now;
};

/// Writes with_lamps() beside the file, as NAME-lamps.lxr or with the next number that is free.
/// Returns where. Errors: those of with_lamps() and of files.
Result<std::filesystem::path> save_lxr(const LampsToSave& to_save);

}  // namespace luxel::view
