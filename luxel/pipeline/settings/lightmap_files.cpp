#include "luxel/pipeline/settings/lightmap_files.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "luxel/export/baked_glb.h"
#include "luxel/image/codec.h"
#include "luxel/image/rgbe.h"
#include "luxel/image/rgbm.h"
#include "luxel/pipeline/settings/comma_list.h"

namespace luxel::pipeline {

Result<LightmapFormats> parse_formats(std::string_view text) {
  LightmapFormats formats;
  for (const std::string_view one : split_at_commas(text)) {
    if (one == "hdr")
      formats.hdr = true;
    else if (one == "rgbm")
      formats.rgbm = true;
    else if (one == "rgbe")
      formats.rgbe = true;
    else if (one != "exr")
      return fail(ErrorCode::bad_setting,
                  "--formats '{}': there is no format '{}'; there is: exr, hdr, rgbm, rgbe, with "
                  "commas between them",
                  text, one);
  }
  return formats;
}

nlohmann::json to_json(const LightmapFormats& formats) {
  nlohmann::json names = {"exr"};
  if (formats.hdr) names.push_back("hdr");
  if (formats.rgbm) names.push_back("rgbm");
  if (formats.rgbe) names.push_back("rgbe");
  return names;
}

Result<LightmapFiles> lightmap_files(std::span<const image::Image> lightmaps,
                                     const LightmapFormats& formats,
                                     const std::filesystem::path& folder, std::string_view layer,
                                     std::span<const std::vector<std::byte>> exr_files) {
  LightmapFiles out;
  if (formats.rgbm) out.rgbm_range = image::rgbm_range(lightmaps);
  for (size_t p = 0; p < lightmaps.size(); ++p) {
    const image::Image& lightmap = lightmaps[p];
    const std::string name = export_::lightmap_name(p, lightmaps.size(), layer);
    const auto add = [&](const char* extension, std::vector<std::byte> bytes) {
      out.files.push_back({folder / (name + extension), std::move(bytes)});
    };
    if (exr_files.empty()) {
      LUXEL_TRY(std::vector<std::byte> exr, image::encode_exr(lightmap));
      add(".exr", std::move(exr));
    } else {
      add(".exr", exr_files[p]);
    }
    if (formats.hdr) add(".hdr", image::encode_hdr(lightmap));
    if (formats.rgbm)
      add(".rgbm.png", image::encode_png(image::rgbm_picture(lightmap, out.rgbm_range)));
    if (formats.rgbe) add(".rgbe.png", image::encode_png(image::rgbe_picture(lightmap)));
  }
  return out;
}

std::vector<std::filesystem::path> lightmaps_in(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> out;
  if (const auto text = read_file(folder / "bake.json")) {
    const char* begin = reinterpret_cast<const char*>(text->data());
    const auto json = nlohmann::json::parse(begin, begin + text->size(), nullptr, false);
    const nlohmann::json::json_pointer where("/atlas/pages");
    if (json.contains(where))
      for (const nlohmann::json& page : json[where])
        if (page.contains("file") && page["file"].is_string())
          out.push_back(folder / page["file"].get<std::string>());
  }
  if (out.empty()) out.push_back(folder / "lightmap.exr");
  return out;
}

}  // namespace luxel::pipeline
