// Files in which the parts of a bake are that several processes share out: luxel bake --part.
#pragma once

#include <filesystem>
#include <vector>

#include "luxel/pipeline/settings/settings.h"

namespace luxel::pipeline {

/// FOLDER/part-3-of-16.luxel; of a bake that is not shared out FOLDER/checkpoint.luxel.
std::filesystem::path parts_file(const BakeSettings& settings);

/// The files of parts in a folder, by name.
std::vector<std::filesystem::path> part_files_in(const std::filesystem::path& folder);

/// The files of parts that a bake looks into besides its own: settings.parts, and for a part of it
/// those in its folder.
std::vector<std::filesystem::path> other_parts(const BakeSettings& settings);

}  // namespace luxel::pipeline
