// Meshes as glTF.
#pragma once

#include "luxel/export/gltf_material.h"
#include "luxel/export/lightmap_vertices.h"

namespace luxel::export_ {

/// Appends a mesh with one primitive per material and page of the lightmap (in the order of the
/// first triangle of each; the triangles inside keep their order) and returns its index. With a
/// lightmap TEXCOORD_1 holds its coordinates, vertices are split where they differ, and the mesh's
/// own second set moves to TEXCOORD_2 if a texture needs it. Normal maps then come with normals
/// and tangents, and one that is mirrored on some triangles has a primitive for those. The mesh has
/// triangles.
size_t append_mesh(Glb& glb, MaterialBook& book, const scene::Scene& scene, const scene::Mesh& mesh,
                   const LightmapCoordinates& lightmap);

}  // namespace luxel::export_
