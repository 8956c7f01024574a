#include "luxel/pipeline/settings/import_options.h"

#include <filesystem>

#include "luxel/pipeline/settings/option_rows.h"

namespace luxel::pipeline {

namespace {

using import::ImportParams;

/// bake.json does not keep it, nor --trust-paths: whoever uses a file of settings again decides
/// anew what its scene may open.
Option<ImportParams> search_path_option() {
  using Paths = std::vector<std::filesystem::path>;
  Option<ImportParams> row =
      Rows<ImportParams>::text(
          "--search-path", &ImportParams::search_paths,
          [](std::string_view text) -> Result<Paths> { return Paths{text}; },
          [](const Paths& paths) {
            nlohmann::json out = paths.empty() ? nlohmann::json() : nlohmann::json::array();
            for (const std::filesystem::path& path : paths) out.push_back(path.string());
            return out;
          },
          "Also look in this folder for pictures and buffers that the scene names; repeatable")
          .key_is("")
          .unit("DIR")
          .leaves(Changes::scene);
  row.repeats = true;
  row.read_text = [](ImportParams& params, std::string_view text) -> Status {
    std::error_code ignored;
    if (!std::filesystem::is_directory(text, ignored))
      return fail(ErrorCode::bad_setting, "--search-path {}: there is no such folder", text);
    return params.search_paths.emplace_back(text), Status{};
  };
  return row;
}

}  // namespace

Options<ImportParams> import_options() {
  return {Rows<ImportParams>::number(
              "--smooth-normals", &ImportParams::smooth_normals_deg, {0, 180},
              fmt::format("For meshes without normals: smooth across edges that bend by at most "
                          "this angle; 0: flat; default: {} for OBJ, PLY and STL, else flat",
                          import::kUsualCreaseDeg))
              .key_is("smooth_normals_deg")
              .unit("DEG")
              .leaves(Changes::scene),
          Rows<ImportParams>::choice(
              "--up", &ImportParams::up, {{"y", import::Up::y}, {"z", import::Up::z}},
              "Axis that points up in a file that does not say (OBJ, PLY, STL, ...); default: y")
              .leaves(Changes::scene),
          Rows<ImportParams>::choice("--unit", &ImportParams::unit_m,
                                     {{"mm", 0.001f},
                                      {"cm", 0.01f},
                                      {"m", 1.0f},
                                      {"km", 1000.0f},
                                      {"in", 0.0254f},
                                      {"ft", 0.3048f}},
                                     "Unit of lengths in a file that does not say (OBJ, PLY, STL, "
                                     "...); default: m")
              .leaves(Changes::scene),
          search_path_option(),
          Rows<ImportParams>::toggle(
              "--trust-paths", &ImportParams::trust_paths,
              "Read the files that the scene names even if they lie outside its folder")
              .key_is("")
              .leaves(Changes::scene),
          Rows<ImportParams>::toggle(
              "--any-format", &ImportParams::any_format,
              "Also read formats that only Assimp knows (3DS, Blender, IFC, LightWave, ...), in a "
              "process of their own")
              .key_is("")
              .leaves(Changes::scene)};
}

}  // namespace luxel::pipeline
