// The parts of a glTF document that become parts of the scene. For the glTF reader only.
#pragma once

#include <tiny_gltf.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "luxel/base/result.h"
#include "luxel/import/import.h"
#include "luxel/import/readers.h"

namespace luxel::import {

/// World from node, of every node of a document: in single precision, and as the file says it.
struct WorldTransforms {
  std::vector<Mat34> rounded;
  std::vector<DMat34> exact;
};

/// State that the steps of the reader share. Materials and meshes keep their glTF index in the
/// scene.
struct GltfReader {
  const nlohmann::json& document;  ///< as the file says it, without its nodes
  const tinygltf::Model& model;
  const SourceFile& source;
  Imported& out;
  ExactPlaces& exact;
  WorldTransforms world;
  uint32_t default_material = scene::kNone;  ///< made when a primitive first needs it
  /// The set of texture coordinates that becomes a mesh's first one, for each material of the file.
  std::vector<int> first_set{};

  template <class... Args>
  void warn(fmt::format_string<Args...> text, Args&&... args) {
    out.warnings.push_back(source.name + ": " + fmt::format(text, std::forward<Args>(args)...));
  }
};

/// Fills scene.materials and the textures they use. Errors: a texture that is missing or corrupt.
Status read_materials(GltfReader& reader);

WorldTransforms world_transforms(const tinygltf::Model& model);

/// One scene::Mesh per glTF mesh, its primitives merged; one without triangles where each node that
/// draws it has a pose of its own. Errors: indices beyond the vertices; those of the pose.
Status read_meshes(GltfReader& reader);

/// Appends the mesh that a node draws, in the node's own pose. Errors: those of read_meshes();
/// memory.
Result<scene::Mesh> posed_mesh(GltfReader& reader, size_t node);

/// Instances, lights and cameras of the default scene's nodes.
Status read_nodes(GltfReader& reader);

/// A number, or numbers, of an extension; the fallback when absent or of another kind.
double number_in(const tinygltf::Value& object, const char* key, double fallback);
Vec2 vec2_in(const tinygltf::Value& object, const char* key, Vec2 fallback);
Rgb vec3_in(const tinygltf::Value& object, const char* key, Rgb fallback);
inline Vec3 vec3_of(const std::vector<double>& v, Vec3 fallback) {
  return v.size() < 3 ? fallback : Vec3{float(v[0]), float(v[1]), float(v[2])};
}

}  // namespace luxel::import
