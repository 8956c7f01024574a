// Names of files that are never written over.
#pragma once

#include <filesystem>
#include <string>

namespace luxel::view {

/// FOLDER/NAME.EXTENSION, or with the next number that is free: NAME-2, NAME-3, ... `extension`
/// begins with its dot.
std::filesystem::path free_name(const std::filesystem::path& folder, const std::string& name,
                                const std::string& extension);

}  // namespace luxel::view
