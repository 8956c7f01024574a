#include "luxel/pipeline/bake/layers.h"

#include <nlohmann/json.hpp>
#include <numeric>

#include "luxel/base/check.h"
#include "luxel/base/free_memory.h"
#include "luxel/base/parallel.h"
#include "luxel/light/layer_instances.h"
#include "luxel/pipeline/texels/shown_light.h"
#include "luxel/post/dilate.h"
#include "luxel/scene/sides.h"

namespace luxel::pipeline {
namespace {

std::vector<image::Image> dilated_pages(const atlas::Atlas& atlas, const atlas::TexelMap& map,
                                        std::span<const Rgb> values, int rings) {
  std::vector<image::Image> pages = post::lightmap_pages(atlas, map, values);
  for (image::Image& page : pages) post::dilate(page, rings);
  return pages;
}

Rgb mean_of(std::span<const Rgb> values) {
  double x = 0, y = 0, z = 0;
  for (const Rgb& v : values) x += double(v.x), y += double(v.y), z += double(v.z);
  const double n = double(std::max<size_t>(1, values.size()));
  return {float(x / n), float(y / n), float(z / n)};
}

}  // namespace

Status stitch_layers(const atlas::TexelMap& map, std::span<const post::Seam> seams,
                     const post::SeamParams& params, std::span<const Rgb> before,
                     std::span<const Rgb> after, std::span<std::vector<Rgb>> layers,
                     Progress& progress) {
  LUXEL_TRY_STATUS(post::stitch_layers(map, seams, params, before, layers, progress));
  fit_layers(after, layers);
  return {};
}

void fit_layers(std::span<const Rgb> whole, std::span<std::vector<Rgb>> layers) {
  if (layers.empty()) return;
  parallel_for(whole.size(), 4096, [&](size_t begin, size_t end) {
    std::vector<Rgb> own(layers.size());
    for (size_t i = begin; i < end; ++i) {
      for (size_t l = 0; l < own.size(); ++l) own[l] = layers[l][i];
      light::share_out(whole[i], own);
      for (size_t l = 0; l < own.size(); ++l) layers[l][i] = own[l];
    }
  });
}

std::vector<BakedLayer> bake_layers(const scene::Scene& scene, const atlas::Atlas& atlas,
                                    const atlas::TexelMap& map, int rings, TexelLight& light) {
  std::vector<BakedLayer> out(light.layers.size());
  const bool scatters = scene::scatters_light(scene);
  parallel_for(out.size(), 1, [&](size_t l, size_t) {
    std::vector<Rgb>& irradiance = light.layer_irradiance[l];
    out[l].about = std::move(light.layers[l]);
    out[l].mean_irradiance = mean_of(irradiance);
    out[l].lightmaps = dilated_pages(atlas, map, irradiance, rings);
    if (scatters)
      out[l].shown =
          dilated_pages(atlas, map, shown_irradiance(scene, atlas, map, irradiance), rings);
    free_memory(irradiance);
  });
  light.layers.clear(), light.layer_irradiance.clear();
  double all = 0;
  for (const BakedLayer& layer : out) all += double(luminance(layer.mean_irradiance));
  for (BakedLayer& layer : out)
    layer.share = all > 0 ? double(luminance(layer.mean_irradiance)) / all : 0;
  return out;
}

Status note_lights(const scene::Scene& scene, const light::Lights& lights, light::LayerMode mode,
                   std::span<BakedLayer> layers) {
  if (layers.empty()) return {};
  LUXEL_TRY(const light::LightLayers found, light::light_layers(scene, lights, mode));
  LUXEL_CHECK(found.size() == layers.size());
  std::vector<std::vector<uint32_t>> instances = light::instances_of_layers(lights, found);
  for (size_t l = 0; l < layers.size(); ++l) {
    layers[l].instances = std::move(instances[l]);
    layers[l].surroundings = found.of_surroundings == l;
  }
  return {};
}

Result<std::vector<OutputFile>> layer_files(std::span<const BakedLayer> layers,
                                            const LightmapFormats& formats,
                                            const std::filesystem::path& folder,
                                            nlohmann::json& json) {
  std::vector<Result<LightmapFiles>> encoded(layers.size());
  parallel_for(layers.size(), 1, [&](size_t l, size_t) {
    encoded[l] = lightmap_files(layers[l].lightmaps, formats, folder, layers[l].about.name);
  });
  std::vector<OutputFile> out;
  for (size_t l = 0; l < layers.size(); ++l) {
    LUXEL_TRY(LightmapFiles own, std::move(encoded[l]));
    const Rgb mean = layers[l].mean_irradiance;
    nlohmann::json about = {{"name", layers[l].about.name},
                            {"lights", layers[l].about.lights},
                            {"share", layers[l].share},
                            {"mean_irradiance", {mean.x, mean.y, mean.z}},
                            {"files", nlohmann::json::array()}};
    if (own.rgbm_range > 0) about["rgbm_range"] = own.rgbm_range;
    if (own.half_scale > 0) about["half_scale"] = own.half_scale;
    for (const OutputFile& file : own.files)
      about["files"].push_back(file.path.filename().string());
    json.push_back(std::move(about));
    std::move(own.files.begin(), own.files.end(), std::back_inserter(out));
  }
  return out;
}

}  // namespace luxel::pipeline
