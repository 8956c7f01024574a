#include "luxel/pipeline/bake/finish_bake.h"

#include <algorithm>

#include "luxel/pipeline/texels/shown_light.h"
#include "luxel/pipeline/texels/texel_picture.h"
#include "luxel/post/dilate.h"
#include "luxel/post/refill.h"
#include "luxel/post/seams.h"
#include "luxel/scene/sides.h"

namespace luxel::pipeline {
namespace {

/// Texels that have nothing to tell of the light at seams: hidden ones, and those of a kept
/// TEXCOORD_1 which look-ups on another chart blend in. Stitching would spread their light.
std::vector<uint8_t> not_to_stitch(const Bake& bake) {
  std::vector<uint8_t> out = bake.light.hidden;
  if (!bake.atlas.kept) return out;
  out.resize(bake.map.texels.size());
  for (const uint32_t i : atlas::blended_texels(bake.atlas, bake.map)) out[i] = 1;
  return out;
}

/// Stitches all light of a bake: the whole, its layers and the maps beside it.
Status stitch(std::span<const post::Seam> seams, const post::SeamTexels& texels, Bake& bake,
              Progress& progress) {
  const post::SeamParams params{.texels = texels};
  std::vector<Rgb> before;
  if (!bake.light.layers.empty()) before = bake.light.irradiance;
  LUXEL_TRY_STATUS(post::stitch_seams(bake.map, seams, params, bake.light.irradiance, progress));
  for (SurfaceMap& map : bake.surface_maps)
    for (std::vector<Rgb>& values : map.values)
      LUXEL_TRY_STATUS(post::stitch_seams(bake.map, seams, params, values, progress));
  if (before.empty()) return {};
  return stitch_layers(bake.map, seams, params, before, bake.light.irradiance,
                       bake.light.layer_irradiance, progress);
}

/// Gives hidden texels beside open ones their light, in all that a bake has of it.
void refill(const post::Parted& parted, Bake& bake) {
  std::vector<std::span<Rgb>> arrays{bake.light.irradiance};
  for (std::vector<Rgb>& layer : bake.light.layer_irradiance) arrays.push_back(layer);
  for (SurfaceMap& map : bake.surface_maps)
    arrays.insert(arrays.end(), map.values.begin(), map.values.end());
  bake.repair.refilled =
      post::refill_hidden(bake.atlas, bake.map, bake.light.hidden, kRefillRings, parted, arrays);
}

}  // namespace

Status repair_light(const BakeSettings& settings, const trace::RayTracer& tracer,
                    std::span<const uint32_t> regions, Bake& bake, Progress& progress, Team* team) {
  progress.begin("seams", 0);
  const std::vector<uint8_t> hidden = not_to_stitch(bake);
  // Hidden texels have no light to tell, so seams are stitched without them, and they take what
  // their neighbours have then.
  std::vector<post::Seam> seams = post::find_seams(bake.scene, bake.atlas);
  if (settings.repair_leaks) {
    LUXEL_TRY(seams, open_seams(bake.scene, bake.atlas, tracer, seams, progress, team));
  }
  const post::SeamTexels texels{hidden, regions};
  bake.seam_residual_before = post::seam_residual(bake.map, seams, bake.light.irradiance, texels);
  bake.seams = seams.size();
  if (settings.stitch) LUXEL_TRY_STATUS(stitch(seams, texels, bake, progress));
  bake.seam_residual_after = post::seam_residual(bake.map, seams, bake.light.irradiance, texels);
  refill(settings.repair_leaks ? parted_texels(bake.scene, bake.atlas, bake.map, tracer)
                               : post::Parted{},
         bake);
  if (settings.texels)
    bake.texel_pictures = draw_texels(
        bake.atlas, bake.map,
        {bake.light.hidden, bake.repair.overlapping, bake.repair.moved, bake.repair.refilled,
         post::seam_errors(bake.map, seams, bake.light.irradiance, texels)});
  if (settings.error_map)
    bake.error_pictures = draw_errors(bake.atlas, bake.map, bake.light.errors);
  bake.lightmaps = post::lightmap_pages(bake.atlas, bake.map, bake.light.irradiance);
  for (image::Image& lightmap : bake.lightmaps) post::dilate(lightmap, post::kDilationRings);
  if (scene::scatters_light(bake.scene)) {
    bake.shown = post::lightmap_pages(
        bake.atlas, bake.map,
        shown_irradiance(bake.scene, bake.atlas, bake.map, bake.light.irradiance));
    for (image::Image& lightmap : bake.shown) post::dilate(lightmap, post::kDilationRings);
  }
  for (SurfaceMap& map : bake.surface_maps)
    make_pages(bake.atlas, bake.map, post::kDilationRings, map);
  bake.layers = bake_layers(bake.scene, bake.atlas, bake.map, post::kDilationRings, bake.light);
  return stopped(progress);
}

Status add_directions(const BakeSettings& settings, const light::TexelScene& input, Bake& bake,
                      Progress& progress) {
  const std::span<const Rgb> light = bake.light.irradiance;
  if (settings.directional != Directional::none) {
    LUXEL_TRY(bake.directions, direction_maps(input, light, bake.light.hidden, settings.directional,
                                              settings.seed, progress));
    bake.light.rays += bake.directions.rays;
  }
  if (settings.probe_spacing_m > 0) {
    LUXEL_TRY(bake.probes,
              probe_grid(input, light, float(settings.probe_spacing_m), settings.seed, progress));
    bake.light.rays += bake.probes->rays;
  }
  return {};
}

}  // namespace luxel::pipeline
