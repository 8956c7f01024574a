// Tangents for normal maps: without them each viewer makes its own.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "luxel/export/lightmap_vertices.h"
#include "luxel/scene/scene.h"

namespace luxel::export_ {

/// The mesh with a normal for each triangle's plane, which no two triangles share: glTF wants
/// meshes without normals flat, but gives them no tangents. Triangles keep their order.
scene::Mesh with_flat_normals(const scene::Mesh& mesh);

/// Where the material's normal map lies on the mesh, per vertex; empty: the mesh needs no tangents,
/// or lacks the normals or coordinates for them.
std::vector<Vec2> normal_map_places(const scene::Mesh& mesh, const scene::Material& material);

/// A triangle shows the map mirrored. Such triangles share no vertex with others.
bool is_mirrored(std::span<const Vec2> places, const std::array<uint32_t, 3>& triangle);

/// TANGENT of glTF 2.0 for vertices whose triangles are all mirrored, or none: x, y, z along
/// growing u, at right angles to the normal, and w = 1 or -1 so that w cross(normal, tangent) goes
/// along falling v. Directions of triangles are averaged as scene::bent_normal() has them.
std::vector<std::array<float, 4>> tangents(const scene::Mesh& mesh, std::span<const Vec2> places,
                                           const LightmapVertices& vertices, bool mirrored);

}  // namespace luxel::export_
