// The files that `luxel bake` left in a folder, for commands that build on it.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "luxel/base/result.h"
#include "luxel/image/image.h"
#include "luxel/pipeline/settings/outside_light.h"
#include "luxel/scene/scene.h"

namespace luxel::pipeline {

/// Lightmaps of a bake's folder, one for each page of its atlas.
struct LightmapPages {
  std::vector<image::Image> pictures;
  std::vector<size_t> of_material;  ///< index into pictures

  /// The picture of a surface point of baked.glb.
  const image::Image& of(const scene::Scene& scene, const scene::SurfacePoint& p) const {
    const scene::Mesh& mesh = scene.meshes[scene.instances[p.instance].mesh];
    return pictures[of_material[mesh.triangle_material[p.triangle]]];
  }
};

/// read(file) for every lightmap that the materials of baked.glb name; those that name none have
/// lightmap.exr. `materials` is how many baked.glb has, once imported. Errors: those of files.
Result<LightmapPages> read_pages(
    const std::filesystem::path& folder, size_t materials,
    const std::function<Result<image::Image>(const std::filesystem::path& lightmap)>& read);

/// An EXR picture. Errors: those of files.
Result<image::Image> read_lightmap(const std::filesystem::path& file);

/// baked.glb, without light from outside, with this Scene::origin; none: as the reader chooses.
/// Errors: there is none, or it is broken.
Result<scene::Scene> scene_of_bake(const std::filesystem::path& folder,
                                   const std::optional<DVec3>& origin = {});

/// Errors (bad_input): baked.glb has no colours of its own for the lightmap to light.
Status check_has_colors(const std::filesystem::path& folder);

/// Errors (bad_input): bake.json says that the lightmap holds a part of the light only (--light).
Status check_has_all_light(const std::filesystem::path& folder);

/// Light from outside: `given`, or, where that is empty, what bake.json of `folder` names. A file
/// of it that is gone is left out with a warning. An empty folder has no bake.
OutsideLight outside_light_of_bake(const std::filesystem::path& folder, const OutsideLight& given,
                                   std::vector<std::string>& warnings);

}  // namespace luxel::pipeline
