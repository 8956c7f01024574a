// Files to scenes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "luxel/base/result.h"
#include "luxel/scene/scene.h"

namespace luxel::import {

/// Contents of a file.
struct Imported {
  scene::Scene scene;                 ///< validated (luxel/scene/validate.h)
  std::vector<std::string> warnings;  ///< one sentence each
  /// For scenes without light: why the file may have lost its lights, and what to tick to keep
  /// them. Half a sentence; empty when that is not known.
  std::string about_lost_lights;
  /// The node of a glTF file that each instance and each light comes from. Empty for other files.
  std::vector<uint32_t> node_of_instance, node_of_light;
  /// Taken off the coordinates of each instance's mesh (far_scene.h); empty: nothing.
  std::vector<DVec3> object_origin;
  bool is_smoothed = false;  ///< by the smoothing groups of an .obj file
};

enum class Up : uint8_t { y, z };

/// Settings for reading a file.
struct ImportParams {
  /// Crease angle of smooth normals for meshes without normals [degrees], 0 to 180; 0: they are
  /// flat. Not set: kUsualCreaseDeg for .ply, .stl and .obj, unless that states smoothing groups,
  /// which are followed then; flat for everything else, as glTF demands.
  std::optional<float> smooth_normals_deg{};
  /// Folders besides the scene's own in which files may lie that the scene names (scene_files.h).
  std::vector<std::filesystem::path> search_paths{};
  bool trust_paths = false;  ///< files that the scene names may lie anywhere
  /// Formats that only Assimp knows are read too, in a process of their own (other_process.h).
  bool any_format = false;
  /// For formats that state neither (OBJ, PLY, STL, .x, ...): the axis that points up, and metres
  /// per unit. Not set: Y, metres. Set for another format: an error (bad_setting).
  std::optional<Up> up{};
  std::optional<float> unit_m{};
  /// Scene::origin. Not set: one near the scene, where that lies far from its own.
  std::optional<DVec3> origin{};
};
inline constexpr float kUsualCreaseDeg = 60;

/// Reads glTF with tinygltf, OBJ with tinyobjloader, and FBX, .x, Collada, PLY and STL through
/// Assimp. The content decides, whatever the file's name ends in. Errors say file, field, value and
/// what to do. unsupported: another format, without `any_format`.
/// out_of_memory: what the file holds needs more than `max_memory_bytes`, which the process may
/// have while it reads (0: what the machine has free); it is said before it is used.
Result<Imported> import_scene(const std::filesystem::path& path, const ImportParams& params = {},
                              uint64_t max_memory_bytes = 0);

/// True for a glTF file, judged by its first bytes, or by its name where those say nothing.
bool is_gltf_file(const std::filesystem::path& path);

/// Imports a file that lies in memory and names no other. `name` is for messages; its extension
/// counts where the content does not say what the file is.
Result<Imported> import_bytes(std::vector<std::byte> bytes, const std::string& name,
                              uint64_t max_memory_bytes = 0);

/// Imports a binary glTF file that lies in memory, self-contained; `name` is for messages.
Result<Imported> import_glb(std::vector<std::byte> bytes, const std::string& name,
                            const ImportParams& params = {});

}  // namespace luxel::import
