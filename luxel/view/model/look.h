// All that a bake shows besides its light.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "luxel/base/result.h"
#include "luxel/image/codec.h"
#include "luxel/image/half.h"
#include "luxel/pipeline/bake/baked_folder.h"
#include "luxel/view/frame.h"
#include "luxel/view/lit_scene.h"
#include "luxel/view/model/charts.h"

namespace luxel::view {

/// A bake, looked into.
struct Look {
  std::string unit;                     ///< of E; who looks knows it
  ColorScale irradiance, density;       ///< that fit this bake
  std::vector<MeshCharts> charts;       ///< of each mesh
  uint32_t chart_count = 0;             ///< of all meshes
  std::vector<image::Image8> texels;    ///< texels.png of each page; none without bake --texels
  std::vector<image::Image8> errors;    ///< error.png of each page; none without bake --error-map
  std::vector<image::Image8> overlaps;  ///< uv_overlaps()
};

/// The look of a scene with these lightmaps, without its unit and the pictures of the folder.
/// E runs up to a round number that 98 % of the texels stay below; the density by its logarithm,
/// from the first percentile of the surface to the last. `light_uv`: of each mesh and vertex its
/// place in the lightmap; empty: uv1 is.
Look look_at(const scene::Scene& scene, const pipeline::LightmapPages& lightmaps,
             std::span<const std::vector<Vec2>> light_uv = {});

/// look_at() and what lies in the bake's folder. Errors: those of files; texels.png or error.png of
/// another size than the lightmap.
Result<Look> look_into(const std::filesystem::path& folder, const scene::Scene& scene,
                       const pipeline::LightmapPages& lightmaps);

/// A sentence on what the bake in `folder` lacks for `show`; none where it lacks nothing. `folder`
/// is empty while the bake is being made.
std::optional<std::string> missing_for(Show show, const Look& look, const std::string& folder);

/// The scale of a frame: its own, or else that of the bake.
ColorScale scale_of(const ColorScale& own, const ColorScale& of_bake);

/// image::false_color() in 256 steps, as 0xbbggrr.
std::array<uint32_t, 256> packed_false_colors();

/// The unit and the scale of what a frame shows; none where it shows no values.
struct Legend {
  std::string title, unit;
  ColorScale scale;
};
std::optional<Legend> legend_of(const Frame& frame, const Look& look);

/// The value that a frame shows in false colours at a point of baked.glb; none where it shows no
/// values, or error.png, which has colours only.
std::optional<float> value_at(const Frame& frame, const scene::Scene& scene,
                              const pipeline::LightmapPages& lightmaps,
                              const scene::SurfacePoint& point);
/// While a scene is baked: at a point of the scene as it was read, by the pages of light that came
/// last. None, too, where what is drawn has no such triangle.
std::optional<float> value_at(const Frame& frame, const LitScene& lit,
                              std::span<const image::HalfImage> pages,
                              const scene::SurfacePoint& point);
/// A channel of light, or its luminance.
float value_of(Rgb light, Channel channel);

}  // namespace luxel::view
