// The two sides of thin surfaces, each with light of its own.
#pragma once

#include <span>

#include "luxel/scene/scene.h"

namespace luxel::scene {

/// A point seen from the other side, where the surface has two; else nothing.
std::optional<SurfacePoint> other_side_of(const Scene& scene, const SurfacePoint& p);

/// Models of leaves and cloth often hold a sheet twice, once for each side. Finds triangles of a
/// mesh with the same three places, wound against each other, and ties them together in
/// Mesh::other_side, each with at most one; the corners of the later one are rotated to (a, c, b).
/// Where light can go through them, they must have one material and the same places in its
/// pictures. From then on they are one-sided. Returns the number of pairs.
size_t link_sides(Scene& scene);

/// Gives triangles of a mesh a side of their own behind: a copy (a, c, b) at the end of the mesh,
/// with opposite normals; both are one-sided from then on. `chosen`: one flag per triangle, of
/// those without other_side.
void add_backs(Scene& scene, uint32_t mesh, std::span<const uint8_t> chosen);

/// Gives the chosen triangles of a mesh one-sided materials: their backs count as the inside of a
/// solid from then on. `chosen`: one flag per triangle.
void make_one_sided(Scene& scene, uint32_t mesh, std::span<const uint8_t> chosen);

/// A material scatters light through (KHR_materials_diffuse_transmission).
bool scatters_light(const Scene& scene);

}  // namespace luxel::scene
