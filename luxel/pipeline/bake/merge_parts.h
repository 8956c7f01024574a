// `luxel merge`: bakes whose parts others have done.
#pragma once

#include <filesystem>
#include <span>

#include "luxel/base/result.h"
#include "luxel/pipeline/settings/settings.h"

namespace luxel::pipeline {

/// The settings of the bake that files of parts are of, as the first of them says; `parts` are
/// these files, those of a folder where one is named. Without a folder for results; how many
/// threads and how much memory there are is not taken from it. A merge that was stopped goes on.
/// Errors: no such file, it has no parts of a bake, a setting that no option has, a folder without
/// such files.
Result<BakeSettings> settings_of_parts(std::span<const std::filesystem::path> files);

}  // namespace luxel::pipeline
