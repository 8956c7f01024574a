// Scenes of our own, and what they must show: dark houses, whole floors, leaves that let light
// through.
#include "bench/scenes.h"
#include "luxel/base/file.h"
#include "luxel/export/baked_glb.h"
#include "luxel/scene/procedural.h"
#include "luxel/validate/own_scenes.h"

namespace luxel::bench {
namespace {

/// A bake as `luxel bake` would make it of the scene's file.
Result<pipeline::Bake> bake_of(const scene::Scene& scene, pipeline::BakeSettings settings) {
  const std::filesystem::path folder = std::filesystem::temp_directory_path();
  settings.scene = folder / fmt::format("luxel-bench-{}.glb", scene.name);
  settings.output = folder;
  LUXEL_TRY(const std::vector<std::byte> glb, export_::scene_glb(scene));
  LUXEL_TRY_STATUS(write_file_atomically(settings.scene, glb));
  Progress progress;
  Result<pipeline::Bake> bake = pipeline::bake_scene(settings, progress);
  std::error_code ignored;
  std::filesystem::remove(settings.scene, ignored);
  return bake;
}

Status measure_house(Table& table) {
  for (const int resolution : {128, 256, 512}) {
    pipeline::BakeSettings settings;
    settings.resolution = resolution, settings.samples = 64, settings.direct_samples = 16;
    LUXEL_TRY(const pipeline::Bake bake, bake_of(scene::closed_corner(), settings));
    const validate::HouseLight light = validate::house_light(bake);
    const double worst = double(std::max(light.texel, light.lookup)) / light.lawn;
    table.notes.push_back(fmt::format(
        "Closed corner (walls of 1 cm, no door) at {0} x {0}: the brightest of all texels and {1} "
        "lookups inside has {2:.4f} % of the lawn's light.",
        resolution, light.lookups, 100 * worst));
    table.json.push_back({{"scene", "closed corner"},
                          {"resolution_texels", resolution},
                          {"inside_over_outside", worst}});
  }
  return {};
}

Status measure_tiles(Table& table) {
  pipeline::BakeSettings settings;
  settings.resolution = 256, settings.samples = 64;
  LUXEL_TRY(const pipeline::Bake bake, bake_of(scene::tiled_kit(), settings));
  const auto [before, after] =
      std::pair(bake.seam_residual_before.relative_max, bake.seam_residual_after.relative_max);
  table.notes.push_back(
      fmt::format("Twenty tiles under one lamp, 256 x 256: seams differ by {:.2f} % of the light "
                  "there at most, "
                  "{:.0f} % before stitching.",
                  100 * after, 100 * before));
  table.json.push_back({{"scene", "tiled kit"}, {"seam_residual_max", {before, after}}});
  return {};
}

Status measure_foliage(Table& table) {
  Progress progress;
  LUXEL_TRY(const validate::FoliageLight light, validate::foliage_light(1024, progress));
  table.notes.push_back(fmt::format(
      "Foliage: {} texels of the floor against twice 1024 paths: relative RMSE {}; {} of them in "
      "shadow, their mean {:+.2f} %.",
      light.texels, validate::relative_rmse_text(light.floor), light.in_shadow,
      100 * (light.shadow_mean - 1)));
  table.json.push_back({{"scene", "foliage"},
                        {"relative_rmse", light.floor.relative_rmse},
                        {"resolution", light.floor.resolution},
                        {"shadow_mean", light.shadow_mean}});
  return {};
}

}  // namespace

Status measure_own(Table& table) {
  LUXEL_TRY_STATUS(measure_house(table));
  LUXEL_TRY_STATUS(measure_tiles(table));
  return measure_foliage(table);
}

}  // namespace luxel::bench
