// Material libraries of .obj files. For this room only.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "luxel/import/readers.h"

namespace luxel::import {

/// A picture that a material names.
struct MtlPicture {
  std::string name;  ///< empty: none
  bool clamp = false;
  Vec2 scale{1, 1}, offset{0, 0};  ///< of texture coordinates, whose v grows upwards
};

/// A material of a library.
struct MtlMaterial {
  std::optional<Rgb> color;  ///< Kd
  Rgb specular{0, 0, 0}, emission{0, 0, 0};
  float sharpness = 0, alpha = 1, metallic = 0;
  MtlPicture color_picture, emission_picture;
};

/// Materials by name.
using MtlLibrary = std::map<std::string, MtlMaterial, std::less<>>;

/// Adds the materials of a library. What is left out because it is wrong is one warning, with
/// `name` and the line of the first.
void add_library(std::string_view text, const std::string& name, MtlLibrary& out,
                 std::vector<std::string>& warnings);

/// Adds the libraries that an `mtllib` line names after this word: one name with blanks in it, or
/// several. One that cannot be read is a warning.
void add_libraries(std::string_view names, const SourceFile& source, MtlLibrary& out,
                   std::vector<std::string>& warnings);

}  // namespace luxel::import
