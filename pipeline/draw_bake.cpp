#include "pipeline/draw_bake.h"

#include "base/file.h"
#include "display/draw.h"
#include "display/lightmap_lookup.h"
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

Result<image::Image> draw_from_folder(const Subject& subject, const RenderSettings& s,
                                      Progress& progress) {
  LUXEL_TRY(import::Imported baked, import::import_scene(s.from / "baked.glb"));
  LUXEL_TRY(const std::vector<std::byte> bytes, read_file(s.from / "lightmap.exr"));
  LUXEL_TRY(const image::Image lightmap,
            image::decode_exr(bytes, (s.from / "lightmap.exr").string()));
  scene::Scene& scene = baked.scene;
  scene.background = subject.scene.background, scene.environment = subject.scene.environment;
  LUXEL_TRY(const trace::RayTracer tracer, trace::RayTracer::build(scene));
  const auto irradiance = [&](const scene::SurfacePoint& p) {
    return display::lightmap_at(scene, lightmap, p);
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
