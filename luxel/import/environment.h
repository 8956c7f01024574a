// Environment maps from files.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "luxel/base/result.h"
#include "luxel/image/image.h"
#include "luxel/scene/environment.h"

namespace luxel::import {

/// An environment map, and one sentence for each repair.
struct ImportedEnvironment {
  scene::Environment map;
  std::vector<std::string> warnings;
};

/// An equirectangular .hdr or .exr picture, twice as wide as high, in linear light, times `scale`.
/// Negative values, which some programs leave, become 0, with a warning. Errors: no such file,
/// another format, another shape, a value that is not finite; out_of_memory, as import_scene().
Result<ImportedEnvironment> read_environment(const std::filesystem::path& file, float rotation_rad,
                                             float scale, uint64_t max_memory_bytes = 0);

/// An environment from a picture in memory, which errors call `name`.
Result<ImportedEnvironment> environment_from(const image::Image& picture, const std::string& name,
                                             float rotation_rad, float scale);

}  // namespace luxel::import
