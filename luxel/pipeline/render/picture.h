// A picture from a file of any format that luxel reads.
#pragma once

#include <filesystem>
#include <string>

#include "luxel/base/result.h"
#include "luxel/image/codec.h"

namespace luxel::pipeline {

struct Picture {
  std::string name;     ///< the file, for messages
  image::Image linear;  ///< light, or display values decoded to light
  image::Image8 shown;  ///< display values of a PNG or JPEG, in 8 bits; empty for light
  bool hdr() const { return shown.data.empty(); }
};

/// EXR, Radiance HDR, PNG or JPEG, told apart by their first bytes, not by their names.
Result<Picture> read_picture(const std::filesystem::path& path);

}  // namespace luxel::pipeline
