// Meshes as glTF.
#pragma once

#include <array>
#include <span>

#include "export/gltf_material.h"

namespace luxel::export_ {

/// Appends a mesh with one primitive per material (in the order of the first triangle of each; the
/// triangles inside keep their order) and returns its index. With `lightmap_uv`, per triangle the
/// lightmap coordinates of its corners, TEXCOORD_1 holds these, vertices are split where they
/// differ, and the mesh's own second set moves to TEXCOORD_2 if a texture needs it. The mesh has
/// triangles.
size_t append_mesh(Glb& glb, MaterialBook& book, const scene::Scene& scene, const scene::Mesh& mesh,
                   std::span<const std::array<Vec2, 3>> lightmap_uv);

}  // namespace luxel::export_
