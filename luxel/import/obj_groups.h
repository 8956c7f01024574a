// The groups of an .obj under names that Assimp cannot confuse. For this room only.
#pragma once

#include <string>
#include <vector>

#include "luxel/import/readers.h"

namespace luxel::import {

/// The file's text with every `o` and `g` line replaced by a `g` with a number: Assimp ends the
/// name of an `o` at its first blank, and an `o` that is opened again loses its faces to another.
/// Lines with `mtllib` are empty (mtl_text.h).
struct ObjGroups {
  std::string text;
  std::vector<std::string> names;  ///< by number
};

/// A group is what follows a `g` in what follows an `o`, wherever in the file it is opened again;
/// its name is that of the `g`, else of the `o`.
ObjGroups number_groups(const SourceFile& source);

/// The name behind the number that Assimp read; what is no number of ours stays as it is.
std::string name_of_group(const ObjGroups& groups, const std::string& numbered);

}  // namespace luxel::import
