// A lightmap as files, one for every taste of engines.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string_view>
#include <vector>

#include "luxel/base/file.h"
#include "luxel/base/result.h"
#include "luxel/image/image.h"

namespace luxel::pipeline {

/// Files beside NAME.exr, which holds E itself.
struct LightmapFormats {
  bool hdr = false;   ///< NAME.hdr
  bool rgbm = false;  ///< NAME.rgbm.png
  bool rgbe = false;  ///< NAME.rgbe.png
  bool half = false;  ///< NAME.half.exr
  bool ktx2 = false;  ///< NAME.ktx2, BC6H
};

/// "exr,hdr,rgbm,rgbe,half,ktx2", in any order; exr is always written, whether it is named or not.
Result<LightmapFormats> parse_formats(std::string_view text);
/// ["exr", ...].
nlohmann::json to_json(const LightmapFormats& formats);

/// Lightmaps as files, not yet written.
struct LightmapFiles {
  std::vector<OutputFile> files;
  float rgbm_range = 0;  ///< E = range a rgb in every NAME.rgbm.png; 0 where there is none
  /// E = scale rgb in every NAME.half.exr and NAME.ktx2; 0 where there is neither.
  float half_scale = 0;
};

/// Pages of a lightmap as NAME.exr and what `formats` adds, in `folder`. NAME is
/// export_::lightmap_name's, of a layer where one is named. `exr_files`: those of the pages, where
/// they are made already. Error: from the EXR encoder.
Result<LightmapFiles> lightmap_files(std::span<const image::Image> lightmaps,
                                     const LightmapFormats& formats,
                                     const std::filesystem::path& folder,
                                     std::string_view layer = {},
                                     std::span<const std::vector<std::byte>> exr_files = {});

/// The lightmaps of the bake in `folder`, as bake.json lists them; lightmap.exr where it lists none
/// or is not there. Errors: it lists files with other names than those of a bake.
Result<std::vector<std::filesystem::path>> lightmaps_in(const std::filesystem::path& folder);

}  // namespace luxel::pipeline
