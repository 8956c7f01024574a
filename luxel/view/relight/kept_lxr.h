// An .lxr file that a window has made, and whether it is still of the same scene and settings.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "luxel/pipeline/command/relight.h"

namespace luxel::view {

/// FOLDER/relight.lxr. Beside it, FOLDER/relight.json says what it was made of.
std::filesystem::path lxr_in(const std::filesystem::path& folder);

/// The data and warnings of settings.output, if it can be opened instead of being made: it holds
/// this scene by these settings, and is as it was written. None where anything differs, is not
/// there, or cannot be read.
std::optional<pipeline::Relightable> kept_lxr(const scene::Scene& scene,
                                              const pipeline::RelightSettings& settings);

/// Says what the file that was just written to settings.output was made of. Errors: those of files.
Status keep_lxr(const scene::Scene& scene, const pipeline::RelightSettings& settings,
                const std::vector<std::string>& warnings);

}  // namespace luxel::view
