// Where rays start beside a surface: off it by what rounding may do to points of it and no further,
// however far the scene reaches.
#pragma once

#include "luxel/scene/facet.h"

namespace luxel::scene {

/// The size [m] that roundings at a flat surface are a part of, besides its distance from the
/// origin: the largest of its instance's translation, for rays are taken into the space of a shared
/// mesh; of four times the sum |n_k| extent_k, for float misplaces its plane by a part of that,
/// which is 0 for floors and walls along the axes, however long; and of an eighth of the longest
/// extent. `extent_m`: the sides of its box; `n`: its unit normal. Of triangles: Facet::size_m.
float size_for_rounding(const Mat34& world_from_object, Vec3 extent_m, Vec3 n);
/// The distance by which rounding may put a point off its surface [m]: a part of its largest
/// coordinate or of that size.
float rounding_m(Vec3 position, float size_m);
/// Where rays leave a surface: `position` moved along `normal`, the side they leave from, by
/// rounding_m(), so that it does not lie behind the surface.
Vec3 off_surface(Vec3 position, Vec3 normal, float size_m);
/// Where rays leave a place of a triangle to the side of `normal`.
Vec3 off_surface(const Facet& facet, Barycentric at, Vec3 normal);
Vec3 off_surface(const Scene& scene, const SurfacePoint& p, Vec3 normal);

}  // namespace luxel::scene
