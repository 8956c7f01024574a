// Normals for meshes that bring none.
#pragma once

#include <span>

#include "luxel/scene/scene.h"

namespace luxel::scene {

/// Gives a mesh without normals smooth ones: two triangles share the normals of their common edge
/// where the mesh bends by at most `crease_rad` there, and no other triangle has that edge. A
/// normal is the mean of those of the triangles that share it around a position, weighted by their
/// angles there [Thurmer98] and by their areas: a narrow bevel does not bend the faces beside it.
/// Vertices at one position count as one, so that seams of texture coordinates stay invisible;
/// where the surface is creased, vertices are added at the end. A mesh that has normals, or of
/// which nothing is bent smoothly (a cube), stays as it is. Indices are in range. Triangles without
/// area share with none.
void smooth_normals(Mesh& mesh, float crease_rad);
/// Smooths by smoothing groups, one per triangle: two triangles share the normals of their common
/// edge, however it bends, if both have the same group and that is not 0, or if it does not bend.
void smooth_normals(Mesh& mesh, std::span<const uint32_t> group);

}  // namespace luxel::scene
