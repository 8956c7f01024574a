// Meshes as glTF.
#pragma once

#include <array>
#include <span>

#include "luxel/export/gltf_material.h"

namespace luxel::export_ {

/// Where a mesh's triangles lie in the lightmap; both empty where there is none.
struct LightmapCoordinates {
  std::vector<std::array<Vec2, 3>> uv;  ///< per triangle its corners, in [0, 1] of the page
  std::vector<uint32_t> page;           ///< per triangle
  bool attached = true;  ///< false: materials do not show it, and say only where it is
};

/// Appends a mesh with one primitive per material and page of the lightmap (in the order of the
/// first triangle of each; the triangles inside keep their order) and returns its index. With a
/// lightmap TEXCOORD_1 holds its coordinates, vertices are split where they differ, and the mesh's
/// own second set moves to TEXCOORD_2 if a texture needs it. The mesh has triangles.
size_t append_mesh(Glb& glb, MaterialBook& book, const scene::Scene& scene, const scene::Mesh& mesh,
                   const LightmapCoordinates& lightmap);

}  // namespace luxel::export_
