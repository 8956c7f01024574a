// Light profiles from IES files for punctual lights of a scene.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "luxel/base/result.h"
#include "luxel/scene/scene.h"

namespace luxel::pipeline {

struct IesSetting {
  std::string light;  ///< its name in the scene
  std::filesystem::path file;
  float scale = 1;  ///< on the file's candela
};

/// "NAME=FILE" or "NAME=FILE,SCALE"; the name ends at the first '='. What follows the last comma is
/// a scale if it is a number.
Result<IesSetting> parse_ies_setting(std::string_view text);

/// Reads the files and gives their distributions to all point and spot lights of those names. What
/// it returns are warnings. Errors: those of reading, and a name that no such light has (the
/// sentence lists those there are).
Result<std::vector<std::string>> add_profiles(std::span<const IesSetting> settings,
                                              scene::Scene& scene);

}  // namespace luxel::pipeline
