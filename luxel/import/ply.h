// .ply files, read here and written plainly for Assimp. For this room only.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "luxel/import/readers.h"

namespace luxel::import {

/// The types of a .ply file's numbers; `none` where there is none.
enum class PlyType { none, i8, u8, i16, u16, i32, u32, f32, f64 };

/// A number of every element, or a list of numbers.
struct PlyProperty {
  PlyType type = PlyType::none;
  PlyType list_count = PlyType::none;  ///< of a list; none for a single number
  std::string name;

  bool is_list() const { return list_count != PlyType::none; }
};

struct PlyElement {
  std::string name;
  uint64_t count = 0;
  std::vector<PlyProperty> properties;
};

/// The text before the numbers.
struct PlyHeader {
  enum class Format { none, ascii, little, big } format = Format::none;
  std::vector<PlyElement> elements;
  std::string texture_file;  ///< of a line `comment TextureFile NAME`, as MeshLab writes it
  std::string_view body;     ///< the rest of the file
};

/// Errors: no .ply file, no format, a line that makes no sense, an element twice.
Result<PlyHeader> read_ply_header(const SourceFile& source);

/// A .ply of the same surfaces that Assimp cannot misread.
struct PlainPly {
  std::string text;
  bool has_display_colors = false;  ///< colours are bytes: display values, not linear ones
  DVec3 near = {};                  ///< what vertices are relative to
};

/// Vertices, faces and the first material, little-endian. Assimp's own reader takes comments for
/// elements and an element's name for its count, cannot step over an element that it does not know,
/// keeps one triangle of a strip, and trusts every number.
/// Errors: those of the header; an early end, a number that is none or not finite, an index without
/// a vertex, a face without a corner, no face, memory.
Result<PlainPly> write_plain_ply(const SourceFile& source, std::vector<std::string>& warnings);

}  // namespace luxel::import
