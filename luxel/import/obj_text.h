// An .obj file as tinyobjloader reads it rightly: that takes a wrong number for 0, a comment after
// a face for a corner, and knows neither lines that go on nor colours. For this room only.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "luxel/import/mtl.h"
#include "luxel/import/readers.h"

namespace luxel::import {

/// Lines of each kind, and corners of all faces.
struct ObjCounts {
  uint64_t v = 0, vt = 0, vn = 0, faces = 0, corners = 0;
};

/// Faces of one state have these in common; the text has a line "g N" before the faces of state N.
struct ObjState {
  uint32_t group = 0;      ///< in ObjText::groups
  uint32_t material = 0;   ///< in ObjText::materials
  uint32_t smoothing = 0;  ///< what `s` says; 0: off
};

struct ObjText {
  std::string text;  ///< lines v x y z, vt u v, vn x y z, f v/vt/vn ..., g N: 0 stands for no index
  ObjCounts counts;
  std::vector<ObjState> states;
  std::vector<std::string> groups;     ///< what `o` and `g` say; "" before them
  std::vector<std::string> materials;  ///< what `usemtl` says; "" before it
  std::vector<Rgb> colors;             ///< of each vertex; empty: none has one
  std::vector<uint32_t> lines;         ///< of each face
  MtlLibrary library;                  ///< what `mtllib` says
  bool states_smoothing = false;       ///< there is an `s`
};

/// Errors: a number that is none or not finite, an index out of range, no faces, memory.
Result<ObjText> plain_obj(const SourceFile& source, std::vector<std::string>& warnings);

}  // namespace luxel::import
