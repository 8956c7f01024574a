#include "luxel/pipeline/bake/baked_folder.h"

#include <map>

#include "luxel/base/file.h"
#include "luxel/export/baked_glb.h"
#include "luxel/image/codec.h"
#include "luxel/import/import.h"
#include "luxel/pipeline/settings/settings.h"
#include "luxel/pipeline/solver/bake_options.h"

namespace luxel::pipeline {

Result<LightmapPages> read_pages(
    const std::filesystem::path& folder, size_t materials,
    const std::function<Result<image::Image>(const std::filesystem::path& lightmap)>& read) {
  const std::filesystem::path glb = folder / "baked.glb";
  LUXEL_TRY(const std::vector<std::byte> bytes, read_file(glb));
  LUXEL_TRY(std::vector<std::string> names, export_::lightmap_files_of(bytes, glb.string()));
  names.resize(materials);  // import adds one for triangles that have none
  LightmapPages out;
  std::map<std::string, size_t> known;
  for (const std::string& name : names) {
    const std::string file = name.empty() ? "lightmap.exr" : name;
    const auto [page, fresh] = known.emplace(file, out.pictures.size());
    out.of_material.push_back(page->second);
    if (!fresh) continue;
    LUXEL_TRY(image::Image picture, read(folder / file));
    out.pictures.push_back(std::move(picture));
  }
  return out;
}

Result<image::Image> read_lightmap(const std::filesystem::path& file) {
  LUXEL_TRY(const std::vector<std::byte> bytes, read_file(file));
  return image::decode_exr(bytes, file.string());
}

Result<scene::Scene> scene_of_bake(const std::filesystem::path& folder,
                                   const std::optional<DVec3>& origin) {
  import::ImportParams params;
  params.origin = origin;
  LUXEL_TRY(import::Imported baked, import::import_scene(folder / "baked.glb", params));
  return std::move(baked.scene);
}

Status check_has_colors(const std::filesystem::path& folder) {
  const std::filesystem::path glb = folder / "baked.glb";
  LUXEL_TRY(const std::vector<std::byte> bytes, read_file(glb));
  LUXEL_TRY(const export_::Attach attach, export_::attach_of(bytes, glb.string()));
  if (attach == export_::Attach::lightmap) return {};
  const bool combined = attach == export_::Attach::combined;
  return fail(ErrorCode::bad_input,
              "{} was baked with --attach {}: its textures hold light instead of colours; bake "
              "with --attach lightmap, or draw the file itself with --technique {}",
              glb.string(), combined ? "combined" : "emissive", combined ? "c" : "path");
}

Status check_has_all_light(const std::filesystem::path& folder) {
  const std::filesystem::path json = folder / "bake.json";
  std::error_code ignored;
  BakeSettings baked;
  // Without a bake.json that can be read nothing is known; outside_light_of_bake() says so.
  if (!std::filesystem::exists(json, ignored) || !read_settings(json, baked)) return {};
  if (baked.light == LightPart::all) return {};
  return fail(
      ErrorCode::bad_input,
      "{} was baked with --light {}: its lightmap lacks a part of the light; bake with --light all",
      folder.string(), name_of(baked.light));
}

OutsideLight outside_light_of_bake(const std::filesystem::path& folder, const OutsideLight& given,
                                   std::vector<std::string>& warnings) {
  const bool is_given =
      given.environment || given.background || given.sun || given.sky || !given.ies.empty();
  const std::filesystem::path json = folder / "bake.json";
  std::error_code ignored;
  if (is_given || folder.empty() || !std::filesystem::exists(json, ignored)) return given;
  BakeSettings baked;
  if (const Status read = read_settings(json, baked); !read) {
    warnings.push_back(read.error().message + "; the bake's sky and sun are left out");
    return given;
  }
  OutsideLight out = std::move(baked.outside);
  const auto is_gone = [&](const std::filesystem::path& file) {
    if (std::filesystem::exists(file, ignored)) return false;
    warnings.push_back(
        fmt::format("{} of the bake no longer exists and is left out", file.string()));
    return true;
  };
  if (out.environment && is_gone(out.environment->file)) out.environment.reset();
  std::erase_if(out.ies, [&](const IesSetting& ies) { return is_gone(ies.file); });
  return out;
}

}  // namespace luxel::pipeline
