// Where rays start beside a surface: off it by what rounding may do to points of it and no further,
// however far the scene reaches.
#pragma once

#include "luxel/scene/scene.h"

namespace luxel::scene {

/// The size [m] that roundings at a triangle are a part of, besides its distance from the origin:
/// the largest of its instance's translation, for rays are taken into the space of a shared mesh;
/// of four times the sum |n_k| extent_k over its box, for float misplaces its plane by a part of
/// that, which is 0 for floors and walls along the axes, however long; and of an eighth of its
/// box's longest side. `n`: its unit normal.
float size_for_rounding(const Mat34& world_from_object, const Triangle3& t, Vec3 n);
/// The same of a triangle of a scene.
float size_for_rounding(const Scene& scene, uint32_t instance, uint32_t triangle);
/// How far rounding may put a point off its surface [m]: a part of its largest coordinate or of
/// that size.
float rounding_m(Vec3 position, float size_m);
/// Where rays leave a surface: `position` moved along `normal`, the side they leave from, by
/// rounding_m(), so that it does not lie behind the surface.
Vec3 off_surface(Vec3 position, Vec3 normal, float size_m);
/// Where rays leave a surface point to the side of `normal`.
Vec3 off_surface(const Scene& scene, const SurfacePoint& p, Vec3 normal);

}  // namespace luxel::scene
