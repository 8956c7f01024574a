// A lightmap as files, one for every taste of engines.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string_view>
#include <vector>

#include "base/file.h"
#include "base/result.h"
#include "image/image.h"

namespace luxel::pipeline {

/// Files beside NAME.exr, which holds E itself.
struct LightmapFormats {
  bool hdr = false;   ///< NAME.hdr
  bool rgbm = false;  ///< NAME.rgbm.png
  bool rgbe = false;  ///< NAME.rgbe.png
};

/// "exr,hdr,rgbm,rgbe", in any order; exr is always written, whether it is named or not.
Result<LightmapFormats> parse_formats(std::string_view text);
/// ["exr", ...].
nlohmann::json to_json(const LightmapFormats& formats);

struct LightmapFiles {
  std::vector<OutputFile> files;
  float rgbm_range = 0;  ///< E = range a rgb in NAME.rgbm.png; 0 where there is none
};

/// `lightmap` as NAME.exr and what `formats` adds, in `folder`. Error: from the EXR encoder.
Result<LightmapFiles> lightmap_files(const image::Image& lightmap, const LightmapFormats& formats,
                                     const std::filesystem::path& folder, const std::string& name);

}  // namespace luxel::pipeline
