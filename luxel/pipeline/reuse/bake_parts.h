// Files in which the parts of a bake are that several processes share out: luxel bake --part.
#pragma once

#include <filesystem>
#include <vector>

#include "luxel/base/team.h"
#include "luxel/pipeline/settings/settings.h"

namespace luxel::pipeline {

/// FOLDER/part-3-of-16.luxel; of a bake that is not shared out FOLDER/checkpoint.luxel, and of a
/// process of several that bake together FOLDER/checkpoint-3.luxel. `team`: null: there is one.
std::filesystem::path parts_file(const BakeSettings& settings, const Team* team = nullptr);

/// All files in a folder that are named as checkpoints are, by name: those of several processes,
/// too.
std::vector<std::filesystem::path> checkpoints_in(const std::filesystem::path& folder);

/// The files of parts in a folder, by name.
std::vector<std::filesystem::path> part_files_in(const std::filesystem::path& folder);

/// The files of parts that a bake looks into besides `own`: settings.parts; for a part of a bake,
/// those in its folder; for one that is resumed, all checkpoints there.
std::vector<std::filesystem::path> other_parts(const BakeSettings& settings,
                                               const std::filesystem::path& own);

}  // namespace luxel::pipeline
