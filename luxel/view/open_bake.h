// A bake, read to be looked at.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "luxel/base/result.h"
#include "luxel/pipeline/bake/baked_folder.h"
#include "luxel/pipeline/settings/settings.h"
#include "luxel/scene/scene.h"
#include "luxel/view/frame.h"

namespace luxel::view {

/// Contents of a bake's folder.
struct OpenedBake {
  std::filesystem::path folder;
  scene::Scene scene;  ///< of baked.glb, with the surroundings that it was baked under
  pipeline::LightmapPages lightmaps;
  Frame first;  ///< what is shown first: what preview.png shows, or the scene's own view
  int width = 960, height = 720;  ///< of preview.png
  bool has_layers = false;        ///< read_layers() finds some
  std::string light_unit;         ///< of E: "lux" or "W/m^2"
  std::vector<std::string> warnings;
};

/// The unit of E in a scene that is baked with these settings: the symbol of pipeline::LightUnit.
std::string light_unit_of(const scene::Scene& scene, const pipeline::BakeSettings& settings);

/// `origin`: Scene::origin; none: as the reader chooses. Errors: those of files; a bake without
/// colours for its light, one whose baked.glb is broken.
Result<OpenedBake> open_bake(const std::filesystem::path& folder,
                             const std::optional<DVec3>& origin = {});

}  // namespace luxel::view
