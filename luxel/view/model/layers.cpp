#include "luxel/view/model/layers.h"

#include <algorithm>

#include "luxel/base/file.h"
#include "luxel/base/parallel.h"
#include "luxel/export/baked_glb.h"

namespace luxel::view {
namespace {

constexpr size_t kPixelsPerPart = 4096;

/// The pages of a layer: lightmap-NAME.exr beside lightmap.exr, lightmap-NAME-1.exr beside
/// lightmap-1.exr.
Result<std::vector<image::Image>> read_layer(const std::filesystem::path& folder,
                                             const std::string& name,
                                             const pipeline::LightmapPages& lightmaps) {
  const std::string before = "lightmap";
  const auto read = [&](const std::filesystem::path& lightmap) {
    const std::string number = lightmap.stem().string().substr(before.size());
    return pipeline::read_lightmap(folder / (before + "-" + name + number + ".exr"));
  };
  LUXEL_TRY(pipeline::LightmapPages pages,
            pipeline::read_pages(folder, lightmaps.of_material.size(), read));
  for (size_t i = 0; i < pages.pictures.size(); ++i) {
    const image::Image& from = pages.pictures[i];
    const image::Image& page = lightmaps.pictures[i];
    if (from.width != page.width || from.height != page.height || from.channels < 3)
      return fail(ErrorCode::bad_input,
                  "the layer {} of {} has {} x {} pixels and the lightmap {} x {}: they belong to "
                  "different bakes",
                  name, folder.string(), from.width, from.height, page.width, page.height);
  }
  return std::move(pages.pictures);
}

double light_in(const LayerLight& layer) {
  double out = 0;
  for (const image::Image& page : layer.pages)
    for (int y = 0; y < page.height; ++y)
      for (int x = 0; x < page.width; ++x) out += double(luminance(page.rgb(x, y)));
  return out;
}

void add_scaled(const image::Image& from, Rgb factor, image::Image& to) {
  const auto from_channels = size_t(from.channels), channels = size_t(to.channels);
  const size_t pixels = to.data.size() / channels;
  parallel_for(pixels, kPixelsPerPart, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const float* light = from.data.data() + from_channels * i;
      float* sum = to.data.data() + channels * i;
      sum[0] += factor.x * light[0], sum[1] += factor.y * light[1], sum[2] += factor.z * light[2];
    }
  });
}

Status check_names(const Layers& layers, std::span<const LayerSetting> settings) {
  for (const LayerSetting& setting : settings) {
    const bool is_known = std::ranges::any_of(
        layers.layers, [&](const LayerLight& layer) { return layer.name == setting.name; });
    if (is_known) continue;
    std::string names;
    for (const LayerLight& layer : layers.layers) names += (names.empty() ? "" : ", ") + layer.name;
    return fail(ErrorCode::bad_setting, "there is no layer '{}'; {}", setting.name,
                names.empty() ? "the bake has none, bake with --layers" : "there are " + names);
  }
  return {};
}

}  // namespace

Result<Layers> read_layers(const std::filesystem::path& folder,
                           const pipeline::LightmapPages& lightmaps) {
  const std::filesystem::path glb = folder / "baked.glb";
  LUXEL_TRY(const std::vector<std::byte> bytes, read_file(glb));
  LUXEL_TRY(export_::FileLayers file, export_::layers_of(bytes, glb.string()));
  Layers out;
  out.shines_in = std::move(file.shines_in);
  double all = 0;
  for (const export_::FileLayers::Layer& layer : file.layers) {
    LUXEL_TRY(auto pages, read_layer(folder, layer.name, lightmaps));
    out.layers.push_back({layer.name, layer.surroundings, 0, std::move(pages)});
    all += out.layers.back().share = light_in(out.layers.back());
  }
  if (all > 0)
    for (LayerLight& layer : out.layers) layer.share /= all;
  return out;
}

Rgb factor_of(std::span<const LayerSetting> settings, const std::string& layer) {
  for (const LayerSetting& setting : settings)
    if (setting.name == layer) return setting.color * setting.dimmer;
  return {1, 1, 1};
}

void set_layer(const LayerSetting& setting, std::vector<LayerSetting>& settings) {
  std::erase_if(settings, [&](const LayerSetting& s) { return s.name == setting.name; });
  if (setting != LayerSetting{setting.name}) settings.push_back(setting);
}

Result<std::vector<image::Image>> mixed_light(const Layers& layers,
                                              std::span<const LayerSetting> settings,
                                              const pipeline::LightmapPages& lightmaps) {
  LUXEL_TRY_STATUS(check_names(layers, settings));
  if (settings.empty()) return lightmaps.pictures;
  std::vector<image::Image> out = lightmaps.pictures;
  for (size_t page = 0; page < out.size(); ++page) {
    for (int y = 0; y < out[page].height; ++y)
      for (int x = 0; x < out[page].width; ++x) out[page].set_rgb(x, y, {});
    for (const LayerLight& layer : layers.layers)
      if (const Rgb factor = factor_of(settings, layer.name); max_component(factor) > 0)
        add_scaled(layer.pages[page], factor, out[page]);
  }
  return out;
}

}  // namespace luxel::view
