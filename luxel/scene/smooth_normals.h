// Normals for meshes that bring none.
#pragma once

#include "luxel/scene/scene.h"

namespace luxel::scene {

/// Gives a mesh without normals smooth ones: two triangles share the normals of their common edge
/// where the mesh bends by at most `crease_rad` there, and no other triangle has that edge. A
/// normal is the mean of those of the triangles that share it around a position, weighted by their
/// angles there [Thurmer98]: how a surface is cut into triangles does not matter. Vertices at one
/// position count as one, so that seams of texture coordinates stay invisible; where the surface is
/// creased, vertices are added at the end. A mesh that has normals, or of which nothing is bent
/// smoothly (a cube), stays as it is. Indices are in range, no triangle is without area.
void smooth_normals(Mesh& mesh, float crease_rad);

}  // namespace luxel::scene
