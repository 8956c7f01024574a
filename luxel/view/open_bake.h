// A bake, read to be looked at.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "luxel/base/result.h"
#include "luxel/pipeline/bake/baked_folder.h"
#include "luxel/scene/scene.h"
#include "luxel/view/frame.h"

namespace luxel::view {

/// What lies in a bake's folder.
struct OpenedBake {
  std::filesystem::path folder;
  scene::Scene scene;  ///< of baked.glb, with the surroundings that it was baked under
  pipeline::LightmapPages lightmaps;
  Frame first;  ///< what is shown first: what preview.png shows, or the scene's own view
  int width = 960, height = 720;  ///< of preview.png
  bool has_layers = false;        ///< read_layers() finds some
  std::vector<std::string> warnings;
};

/// Errors: those of files; a bake without colours for its light, one whose baked.glb is broken.
Result<OpenedBake> open_bake(const std::filesystem::path& folder);

}  // namespace luxel::view
