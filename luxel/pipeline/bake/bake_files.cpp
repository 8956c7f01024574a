#include "luxel/pipeline/bake/bake_files.h"

#include <algorithm>
#include <array>
#include <functional>
#include <nlohmann/json.hpp>

#include "luxel/base/parallel.h"
#include "luxel/export/baked_glb.h"
#include "luxel/image/codec.h"
#include "luxel/pipeline/bake/layers.h"
#include "luxel/pipeline/bake/light_directions.h"
#include "luxel/pipeline/bake/lit_pictures.h"
#include "luxel/pipeline/bake/page_light.h"
#include "luxel/pipeline/settings/lightmap_files.h"

namespace luxel::pipeline {
namespace {

const std::vector<image::Image>& shown_lightmaps(const Bake& bake) {
  return bake.shown.empty() ? bake.lightmaps : bake.shown;
}

/// As viewers want them; without pictures only what is said of them.
std::vector<export_::LightmapLayer> shown_layers(const Bake& bake, bool with_pictures) {
  std::vector<export_::LightmapLayer> out;
  for (const BakedLayer& layer : bake.layers) {
    out.push_back({layer.about.name, layer.about.lights, layer.instances, layer.surroundings, {}});
    if (with_pictures) out.back().lightmaps = layer.shown.empty() ? layer.lightmaps : layer.shown;
  }
  return out;
}

/// With the light in pictures; says how they were made.
Result<std::vector<std::byte>> lit_glb_of(const BakeSettings& settings, const Bake& bake,
                                          nlohmann::json& about, Progress& progress) {
  LUXEL_TRY(const export_::LitPictures pictures, lit_pictures(settings, bake, progress));
  about = {{"pixels_per_texel", pictures.scale}, {"exposure", pictures.exposure}};
  if (settings.attach == export_::Attach::emissive) about["strength"] = pictures.strength;
  return export_::lit_glb(bake.scene, bake.atlas, pictures);
}

/// baked.glb, and what bake.json says of pictures in it; null without.
Result<std::vector<std::byte>> glb_of(const BakeSettings& settings, const Bake& bake,
                                      nlohmann::json& about, Progress& progress) {
  if (settings.attach != export_::Attach::lightmap)
    return lit_glb_of(settings, bake, about, progress);
  if (!settings.vertex_colors)
    return export_::baked_glb(bake.scene, bake.atlas, shown_lightmaps(bake),
                              shown_layers(bake, true));
  const VertexLit& lit = *bake.light.vertex_lit;
  return export_::vertex_lit_glb(lit.scene, lit.intensity);
}

/// `glb` is baked.glb. Where that holds its light in another way, or pictures of layers, which the
/// page has already, or leaves instances out, or stands far from 0, where single precision of a
/// graphics card is coarse, the page has one of its own.
Result<OutputFile> view_page(const BakeSettings& settings, const Bake& bake,
                             std::span<const std::byte> glb) {
  std::vector<std::byte> own;
  const std::vector<Lent> lent = light_for_hidden(bake);
  std::vector<export_::LightmapLayer> layers = shown_layers(bake, true);
  std::vector<std::vector<image::Image>> of_layers;
  for (export_::LightmapLayer& layer : layers)
    layer.lightmaps = of_layers.emplace_back(for_page(bake, lent, layer.lightmaps));
  const bool whole = std::ranges::all_of(bake.scene.instances, &scene::Instance::lightmapped);
  if (settings.vertex_colors || settings.attach != export_::Attach::lightmap || !layers.empty() ||
      !whole || bake.scene.origin != DVec3{}) {
    scene::Scene shown = bake.scene;
    shown.origin = {};
    for (scene::Instance& instance : shown.instances) instance.lightmapped = true;
    LUXEL_TRY(own, export_::baked_glb(shown, bake.atlas, shown_lightmaps(bake),
                                      shown_layers(bake, false)));
    glb = own;
  }
  LUXEL_TRY(const std::string html,
            export_::view_html({settings.scene.stem().string(), bake.view, bake.scene.background,
                                bake.atlas.corners.size(), glb,
                                for_page(bake, lent, shown_lightmaps(bake)),
                                &bake.scene.environment, layers}));
  return text_file(settings.output / "view.html", html);
}

/// kind.png, or kind-0.png and so on of several pages.
std::vector<OutputFile> picture_files(std::span<const image::Image8> pages, std::string_view kind,
                                      const std::filesystem::path& folder) {
  std::vector<OutputFile> files;
  for (size_t p = 0; p < pages.size(); ++p) {
    const std::string number = pages.size() == 1 ? "" : fmt::format("-{}", p);
    files.push_back({folder / fmt::format("{}{}.png", kind, number), image::encode_png(pages[p])});
  }
  return files;
}

/// Outputs that take longest to encode.
struct Encoded {
  Result<LightmapFiles> lightmap;
  Result<std::vector<std::byte>> glb;
  nlohmann::json attached;  ///< what bake.json says of it
  std::vector<std::byte> preview;
};

/// At the same time: each is work for one thread, more or less.
Encoded encode(const BakeSettings& settings, const Bake& bake, Progress& progress) {
  Encoded out;
  const std::array<std::function<void()>, 3> tasks{
      [&] {
        out.lightmap = lightmap_files(bake.lightmaps, settings.formats, settings.output, {},
                                      bake.lightmap_exr);
      },
      [&] { out.glb = glb_of(settings, bake, out.attached, progress); },
      [&] { out.preview = image::encode_png(bake.preview); }};
  parallel_for(tasks.size(), 1, [&](size_t task, size_t) { tasks[task](); });
  return out;
}

}  // namespace

Result<std::vector<OutputFile>> files_of(const BakeSettings& settings, const Bake& bake,
                                         nlohmann::json& json, Progress& progress) {
  Encoded encoded = encode(settings, bake, progress);
  LUXEL_TRY(LightmapFiles lightmap, std::move(encoded.lightmap));
  LUXEL_TRY(std::vector<std::byte> glb, std::move(encoded.glb));
  std::vector<OutputFile> files = std::move(lightmap.files);
  if (!encoded.attached.is_null()) json["attached"] = encoded.attached;
  if (lightmap.rgbm_range > 0) json["lightmap"]["rgbm_range"] = lightmap.rgbm_range;
  if (lightmap.half_scale > 0) json["lightmap"]["half_scale"] = lightmap.half_scale;
  const auto append = [&](std::vector<OutputFile> more) {
    std::move(more.begin(), more.end(), std::back_inserter(files));
  };
  if (!bake.layers.empty()) {
    LUXEL_TRY(std::vector<OutputFile> layers,
              layer_files(bake.layers, settings.formats, settings.output,
                          json["layers"] = nlohmann::json::array()));
    append(std::move(layers));
  }
  LUXEL_TRY(std::vector<OutputFile> maps,
            surface_map_files(bake.surface_maps, settings, bake.scene, json));
  append(std::move(maps));
  LUXEL_TRY(std::vector<OutputFile> directions, direction_files(bake.directions, settings.output));
  append(std::move(directions));
  if (bake.probes) {
    LUXEL_TRY(std::vector<OutputFile> probes,
              probe_files(*bake.probes, bake.scene.origin, settings.output));
    append(std::move(probes));
    json["probes"] = {{"placed", bake.probes->probes.size()},
                      {"inside_solids", bake.probes->row.size() - bake.probes->probes.size()}};
  }
  if (settings.html) {
    LUXEL_TRY(OutputFile page, view_page(settings, bake, glb));
    files.push_back(std::move(page));
  }
  files.push_back({settings.output / "baked.glb", std::move(glb)});
  append(picture_files(bake.texel_pictures, "texels", settings.output));
  append(picture_files(bake.error_pictures, "error", settings.output));
  files.push_back({settings.output / "preview.png", std::move(encoded.preview)});
  return files;
}

}  // namespace luxel::pipeline
