// Maps beside the light: shadow masks and ambient occlusion.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

#include "luxel/base/file.h"
#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/image/image.h"
#include "luxel/light/texel_scene.h"
#include "luxel/pipeline/settings/settings.h"

namespace luxel::pipeline {

/// A map of up to four values in [0, 1] per texel.
struct SurfaceMap {
  std::string name;                   ///< of its files: "shadow-mask", "ambient-occlusion"
  size_t channels = 1;                ///< of its files
  std::vector<uint32_t> lights = {};  ///< shadow mask: index into Scene::lights, per channel
  std::vector<std::vector<Rgb>> values = {};  ///< three channels each, per texel of the map
  std::vector<image::Image> pages = {};       ///< what the files hold: `channels` of each page
};

/// The lights that --shadow-mask names, as indices into scene.lights; none where it is not given.
/// Errors (bad_setting): a name that no light has, or no light at all.
Result<std::vector<uint32_t>> masked_lights(const BakeSettings& settings,
                                            const scene::Scene& scene);

/// The maps that are asked for, per texel; without pages. Errors: cancelled.
Result<std::vector<SurfaceMap>> surface_maps(const BakeSettings& settings,
                                             const light::TexelScene& in,
                                             std::span<const uint32_t> masked,
                                             std::span<const uint8_t> hidden, Progress& progress);

/// Makes the pages of a map whose values are repaired, with `rings` of dilation.
void make_pages(const atlas::Atlas& atlas, const atlas::TexelMap& map, int rings, SurfaceMap& out);

/// NAME.png, 8 bits without any curve, and NAME.exr of every page. `json` gets what bake.json says.
Result<std::vector<OutputFile>> surface_map_files(std::span<const SurfaceMap> maps,
                                                  const BakeSettings& settings,
                                                  const scene::Scene& scene, nlohmann::json& json);

}  // namespace luxel::pipeline
