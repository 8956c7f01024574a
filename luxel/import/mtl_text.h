// Material libraries of .obj files. For this room only.
#pragma once

#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "luxel/import/readers.h"

namespace luxel::import {

/// What an .obj file's material libraries say, as one library for Assimp. Its own reader ends the
/// process or the scene for a property before the first material and for a number that is none, so
/// the text has nothing but materials, their colours, numbers and pictures, each checked.
struct MtlText {
  std::string text;                  ///< empty: there is no material
  std::set<std::string> with_color;  ///< the materials that state Kd
};

/// Adds the text of a library. What is left out because it is wrong is one warning, with `name` and
/// the line of the first.
void add_library(std::string_view text, const std::string& name, MtlText& out,
                 std::vector<std::string>& warnings);

/// Adds the libraries that an `mtllib` line names after this word: one name with blanks in it, or
/// several. One that cannot be read is a warning.
void add_libraries(std::string_view names, const SourceFile& source, MtlText& out,
                   std::vector<std::string>& warnings);

}  // namespace luxel::import
