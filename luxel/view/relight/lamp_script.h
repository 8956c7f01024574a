// Lamps as the user has them, kept as a light script: what `luxel relight --play` draws.
#pragma once

#include <filesystem>

#include "luxel/pipeline/command/light_script.h"
#include "luxel/view/model/walk.h"
#include "luxel/view/relight/lamps.h"

namespace luxel::view {

/// One frame with these lamps, as the walk sees it. Materials are named that glow otherwise than in
/// the file. A view without perspective is left to whoever reads the script.
pipeline::LightScript script_of(const Lamps& now, const Lamps& baked, const Walk& walk);

/// Where the lamps of an .lxr file are kept: beside it, NAME-lamps.json.
std::filesystem::path script_beside(const std::filesystem::path& lxr);

/// Writes the script there, for a scene of this origin. Returns what is to be told. Errors: those
/// of files.
Result<std::string> write_lamps(const std::filesystem::path& lxr,
                                const pipeline::LightScript& script, DVec3 origin);

}  // namespace luxel::view
