// Files in which the parts of a bake are that several processes share out: luxel bake --part.
#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "luxel/base/record_file.h"
#include "luxel/pipeline/settings/settings.h"

namespace luxel::pipeline {

/// FOLDER/part-3-of-16.luxel; of a bake that is not shared out FOLDER/checkpoint.luxel.
std::filesystem::path parts_file(const BakeSettings& settings);

/// The files of parts in a folder, by name.
std::vector<std::filesystem::path> part_files_in(const std::filesystem::path& folder);

/// The files of parts that a bake looks into besides its own: settings.parts, and for a part of it
/// those in its folder.
std::vector<std::filesystem::path> other_parts(const BakeSettings& settings);

/// The settings of the bake that files of parts are of, as the first of them says; `parts` are
/// these files, those of a folder where one is named. Without a folder for results; how many
/// threads and how much memory there are is not taken from it. Errors: no such file, it has no
/// parts of a bake, a setting that no option has, a folder without such files.
Result<BakeSettings> settings_of_parts(std::span<const std::filesystem::path> files);

}  // namespace luxel::pipeline
