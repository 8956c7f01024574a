// The numbers of a .ply file, text or binary. For the .ply reader only.
#pragma once

#include "luxel/import/ply.h"

namespace luxel::import {

/// Hands out the numbers of a body one by one.
struct PlyNumbers {
  PlyHeader::Format format;
  std::string_view rest;
  std::string_view line = {};  ///< what is left of it; text only

  /// To the next line of a text, since each element has one of its own. False where there is none.
  bool begin_element();

  /// False at the end of the file or of the element's line, or at a word that is no number of that
  /// type. Infinite and not a number are numbers.
  bool next(PlyType type, double& value);
};

size_t size_of(PlyType type);

/// Appends a number that next() has read, little-endian as all machines are that luxel runs on.
void append(std::string& out, double value, PlyType type);

}  // namespace luxel::import
