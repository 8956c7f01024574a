// The format of a file.
#pragma once

#include <string>
#include <string_view>

#include "luxel/import/readers.h"

namespace luxel::import {

/// The ending that files of a format have: that of the format luxel reads whose content `bytes` is,
/// else `ending`, which the file's name has (lower case, with the dot): a damaged file goes to the
/// reader that can say what is wrong with it. A glTF file is ".gltf" or ".glb".
std::string format_of(const std::vector<std::byte>& bytes, const std::string& ending);

/// True: luxel reads the format itself, or checks a file before Assimp gets it.
bool is_own_format(const std::string& extension);

/// A binary .stl file has no mark, but a size that follows from its number of facets.
bool is_binary_stl(std::string_view file);

/// The name of the format that Assimp, and luxel only through it, reads by the ending of `path`;
/// empty: of none.
std::string name_in_assimp(const std::filesystem::path& path);

/// An error (unsupported) when luxel does not read the file's format in this process. It names the
/// format and says what to convert the file to.
Status check_format(const SourceFile& source);

}  // namespace luxel::import
