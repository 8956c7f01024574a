#include "luxel/pipeline/settings/lightmap_files.h"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include "luxel/export/baked_glb.h"
#include "luxel/image/bc6h.h"
#include "luxel/image/codec.h"
#include "luxel/image/rgbe.h"
#include "luxel/image/rgbm.h"
#include "luxel/pipeline/settings/comma_list.h"

namespace luxel::pipeline {

namespace {

struct Format {
  std::string_view name;
  bool LightmapFormats::*wanted;
};
/// Besides exr, which is always written.
constexpr std::array kFormats{
    Format{"hdr", &LightmapFormats::hdr}, Format{"rgbm", &LightmapFormats::rgbm},
    Format{"rgbe", &LightmapFormats::rgbe}, Format{"half", &LightmapFormats::half},
    Format{"ktx2", &LightmapFormats::ktx2}};

}  // namespace

Result<LightmapFormats> parse_formats(std::string_view text) {
  LightmapFormats formats;
  std::array<std::string_view, kFormats.size()> names;
  std::ranges::transform(kFormats, names.begin(), &Format::name);
  for (const std::string_view one : split_at_commas(text)) {
    const auto* format = std::ranges::find(kFormats, one, &Format::name);
    if (format != kFormats.end())
      formats.*format->wanted = true;
    else if (one != "exr")
      return fail(
          ErrorCode::bad_setting,
          "--formats '{}': there is no format '{}'; choose from: exr, {}, with commas between them",
          text, one, fmt::join(names, ", "));
  }
  return formats;
}

nlohmann::json to_json(const LightmapFormats& formats) {
  nlohmann::json names = {"exr"};
  for (const Format& format : kFormats)
    if (formats.*format.wanted) names.push_back(format.name);
  return names;
}

Result<LightmapFiles> lightmap_files(std::span<const image::Image> lightmaps,
                                     const LightmapFormats& formats,
                                     const std::filesystem::path& folder, std::string_view layer,
                                     std::span<const std::vector<std::byte>> exr_files) {
  LightmapFiles out;
  if (formats.rgbm) out.rgbm_range = image::rgbm_range(lightmaps);
  if (formats.half || formats.ktx2) out.half_scale = image::scale_for_files(lightmaps);
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
    if (out.half_scale == 0) continue;
    const image::HalfImage half = image::to_half(lightmap, out.half_scale);
    if (formats.half) {
      LUXEL_TRY(std::vector<std::byte> exr, image::encode_exr(half));
      add(".half.exr", std::move(exr));
    }
    if (formats.ktx2) add(".ktx2", image::ktx2_of_bc6h(half));
  }
  return out;
}

Result<std::vector<std::filesystem::path>> lightmaps_in(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> out;
  const std::filesystem::path report = folder / "bake.json";
  if (const auto text = read_file(report)) {
    const char* begin = reinterpret_cast<const char*>(text->data());
    const auto json = nlohmann::json::parse(begin, begin + text->size(), nullptr, false);
    const nlohmann::json::json_pointer where("/atlas/pages");
    const nlohmann::json pages = json.contains(where) ? json[where] : nlohmann::json();
    // A stranger's could name files elsewhere, or one file a million times.
    for (size_t p = 0; pages.is_array() && p < pages.size(); ++p) {
      const std::string name = export_::lightmap_name(p, pages.size()) + ".exr";
      if (!pages[p].is_object() || pages[p].value("file", nlohmann::json()) != name)
        return fail(ErrorCode::bad_input, "{}: page {} of {} is not {}; bake the scene again",
                    report.string(), p, pages.size(), name);
      out.push_back(folder / name);
    }
  }
  if (out.empty()) out.push_back(folder / "lightmap.exr");
  return out;
}

}  // namespace luxel::pipeline
