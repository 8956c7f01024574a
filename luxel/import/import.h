// Files to scenes.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "luxel/base/result.h"
#include "luxel/scene/scene.h"

namespace luxel::import {

/// What a file holds.
struct Imported {
  scene::Scene scene;                 ///< validated (luxel/scene/validate.h)
  std::vector<std::string> warnings;  ///< one sentence each
  /// For scenes without light: why the file may have lost its lights, and what to tick to keep
  /// them. Half a sentence; empty when that is not known.
  std::string about_lost_lights;
};

/// How a file is read.
struct ImportParams {
  /// Crease angle of smooth normals for meshes without normals [degrees], 0 to 180; 0: they are
  /// flat. Not set: kUsualCreaseDeg for .ply, and for .obj unless its smoothing groups are all off;
  /// flat for everything else, as glTF demands.
  std::optional<float> smooth_normals_deg;
};
inline constexpr float kUsualCreaseDeg = 30;

/// Reads .gltf and .glb with tinygltf, everything else that Assimp knows (.obj, .x, .fbx, .dae,
/// .ply, ...) through Assimp. Errors say file, field, value and what to do.
Result<Imported> import_scene(const std::filesystem::path& path, const ImportParams& params = {});

/// Imports a binary glTF file that lies in memory, self-contained; `name` is for messages.
Result<Imported> import_glb(std::vector<std::byte> bytes, const std::string& name);

}  // namespace luxel::import
