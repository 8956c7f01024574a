#include "pipeline/draw_bake.h"

#include <map>

#include "base/file.h"
#include "display/draw.h"
#include "display/lightmap_lookup.h"
#include "export/baked_glb.h"
#include "image/codec.h"
#include "import/import.h"
#include "pipeline/bake.h"
#include "transport/irradiance_field.h"

namespace luxel::pipeline {
namespace {

/// Of the bake that is made for a tile: seconds, not minutes.
constexpr int kQuickResolution = 256, kQuickSamples = 64, kQuickDirectSamples = 16;

display::DrawParams size_of(const RenderSettings& settings) {
  display::DrawParams params;
  params.width = settings.width, params.height = settings.height;
  return params;
}

struct Lightmaps {
  std::vector<image::Image> pages;
  std::vector<size_t> of_material;  ///< index into pages
};

/// The files that the materials of baked.glb name; those that name none have lightmap.exr.
Result<Lightmaps> read_lightmaps(const std::filesystem::path& folder, size_t materials) {
  const std::filesystem::path glb = folder / "baked.glb";
  LUXEL_TRY(const std::vector<std::byte> bytes, read_file(glb));
  LUXEL_TRY(std::vector<std::string> names, export_::lightmap_files_of(bytes, glb.string()));
  names.resize(materials);  // import adds one for triangles that have none
  Lightmaps out;
  std::map<std::string, size_t> known;
  for (const std::string& name : names) {
    const std::string file = name.empty() ? "lightmap.exr" : name;
    const auto [page, fresh] = known.emplace(file, out.pages.size());
    out.of_material.push_back(page->second);
    if (!fresh) continue;
    LUXEL_TRY(const std::vector<std::byte> exr, read_file(folder / file));
    LUXEL_TRY(image::Image picture, image::decode_exr(exr, (folder / file).string()));
    out.pages.push_back(std::move(picture));
  }
  return out;
}

Result<image::Image> draw_from_folder(const Subject& subject, const RenderSettings& s,
                                      Progress& progress) {
  LUXEL_TRY(import::Imported baked, import::import_scene(s.from / "baked.glb"));
  LUXEL_TRY(const Lightmaps lightmaps, read_lightmaps(s.from, baked.scene.materials.size()));
  scene::Scene& scene = baked.scene;
  scene.background = subject.scene.background, scene.environment = subject.scene.environment;
  LUXEL_TRY(const trace::RayTracer tracer, trace::RayTracer::build(scene));
  const auto irradiance = [&](const scene::SurfacePoint& p) {
    const scene::Mesh& mesh = scene.meshes[scene.instances[p.instance].mesh];
    const size_t page = lightmaps.of_material[mesh.triangle_material[p.triangle]];
    return display::lightmap_at(scene, lightmaps.pages[page], p);
  };
  return display::draw(scene, tracer, subject.camera, irradiance, size_of(s), progress);
}

Result<image::Image> draw_quick_bake(const Subject& subject, const RenderSettings& s,
                                     Progress& progress) {
  BakeSettings settings;
  settings.scene = s.scene, settings.outside = s.outside;
  settings.output = s.output.parent_path().empty() ? "." : s.output.parent_path();
  settings.bounces = s.bounces.value_or(-1), settings.seed = s.seed.value_or(1);
  settings.resolution = kQuickResolution;
  settings.samples = kQuickSamples, settings.direct_samples = kQuickDirectSamples;
  LUXEL_TRY(const Bake bake, bake_scene(settings, progress));
  LUXEL_TRY(const trace::RayTracer tracer, trace::RayTracer::build(bake.scene));
  const transport::TexelField field{&bake.atlas, &bake.map, bake.light.irradiance};
  const auto irradiance = [&](const scene::SurfacePoint& p) {
    return transport::irradiance_at(field, p);
  };
  return display::draw(bake.scene, tracer, subject.camera, irradiance, size_of(s), progress);
}

}  // namespace

Result<image::Image> draw_lightmap(const Subject& subject, const RenderSettings& settings,
                                   Rendered&, Progress& progress) {
  return settings.from.empty() ? draw_quick_bake(subject, settings, progress)
                               : draw_from_folder(subject, settings, progress);
}

}  // namespace luxel::pipeline
