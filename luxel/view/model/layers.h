// Layers of a bake's light, dimmed and coloured: docs/method/layers.md.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "luxel/base/result.h"
#include "luxel/pipeline/bake/baked_folder.h"
#include "luxel/view/frame.h"

namespace luxel::view {

/// The light of one lamp or group of lamps.
struct LayerLight {
  std::string name;
  bool has_surroundings = false;    ///< the light of background and environment is in it
  double share = 0;                 ///< of the luminance of all layers
  std::vector<image::Image> pages;  ///< E, in the order of the lightmaps
};

/// All light of a bake with --layers; without layers for other bakes.
struct Layers {
  std::vector<LayerLight> layers;
  std::vector<size_t> shines_in;  ///< of each instance of baked.glb; layers.size(): in none
};

/// Errors: those of files; a layer's picture of another size than the lightmap.
Result<Layers> read_layers(const std::filesystem::path& folder,
                           const pipeline::LightmapPages& lightmaps);

/// The factor of a layer's light.
Rgb factor_of(std::span<const LayerSetting> settings, const std::string& layer);
/// Puts a setting in the place of an earlier one of the layer.
void set_layer(const LayerSetting& setting, std::vector<LayerSetting>& settings);

/// The lightmaps of these settings, the sum of all layers; `lightmaps` where nothing is set.
/// Errors (bad_setting): a layer that there is not; the sentence has the names that there are.
Result<std::vector<image::Image>> mixed_light(const Layers& layers,
                                              std::span<const LayerSetting> settings,
                                              const pipeline::LightmapPages& lightmaps);

}  // namespace luxel::view
