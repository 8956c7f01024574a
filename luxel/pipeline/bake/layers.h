// Steps of a bake with --layers: the lightmap's repairs, made for each layer, and the files of
// layers.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

#include "luxel/atlas/atlas.h"
#include "luxel/base/file.h"
#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/image/image.h"
#include "luxel/pipeline/settings/lightmap_files.h"
#include "luxel/pipeline/solver/solvers.h"
#include "luxel/post/seams.h"

namespace luxel::pipeline {

/// A layer of a finished bake.
struct BakedLayer {
  light::LightLayer about;
  std::vector<uint32_t> instances;      ///< light::instances_of_layers
  bool surroundings = false;            ///< the light of background and environment is in it
  Rgb mean_irradiance{};                ///< over the texels [W/m^2]
  double share = 0;                     ///< of the luminance of all layers together
  std::vector<image::Image> lightmaps;  ///< E, 4 channels, per page
  std::vector<image::Image> shown;      ///< for viewers (shown_light.h); empty: the same
};

/// Stitches layers as stitch_seams() stitched their sum: `before` and `after` are the whole's
/// light, and the layers add up to `after` in the end.
Status stitch_layers(const atlas::TexelMap& map, std::span<const post::Seam> seams,
                     const post::SeamParams& params, std::span<const Rgb> before,
                     std::span<const Rgb> after, std::span<std::vector<Rgb>> layers,
                     Progress& progress);

/// Makes layers add up to the whole's light: what that is off their sum goes to each in proportion.
void fit_layers(std::span<const Rgb> whole, std::span<std::vector<Rgb>> layers);

/// The lightmaps of the layers of `light`, which are used up, with `rings` of dilation.
std::vector<BakedLayer> bake_layers(const scene::Scene& scene, const atlas::Atlas& atlas,
                                    const atlas::TexelMap& map, int rings, TexelLight& light);

/// Notes which surfaces shine in which layer. `mode` is that of the bake.
Status note_lights(const scene::Scene& scene, const light::Lights& lights, light::LayerMode mode,
                   std::span<BakedLayer> layers);

/// lightmap-NAME.exr and what `formats` adds for each layer. `json` gets what bake.json says about
/// them, one object per layer.
Result<std::vector<OutputFile>> layer_files(std::span<const BakedLayer> layers,
                                            const LightmapFormats& formats,
                                            const std::filesystem::path& folder,
                                            nlohmann::json& json);

}  // namespace luxel::pipeline
