// Where an instance stands, as numbers that people type.
#pragma once

#include "luxel/base/vec.h"

namespace luxel::view {

/// An instance's transform, taken apart about a place of the object, its middle.
struct Placement {
  Vec3 place;           ///< of the object's middle in the world [m]
  Vec3 angles_deg;      ///< turned by z, then by x, then by y, about the world's axes
  Vec3 scale{1, 1, 1};  ///< along the object's axes; x < 0: mirrored
};

/// The turn of a sheared transform is that of its first axis and of the plane of the first two.
Placement placement_of(const Mat34& world_from_object, Vec3 middle);

/// The transform with another placement. It stays as it is, bit by bit, where nothing differs, and
/// keeps its shear. Scales are not 0.
Mat34 placed(const Mat34& world_from_object, Vec3 middle, const Placement& now);

/// Orthonormal axes along those of the object, right-handed.
Mat34 turn_of(const Mat34& world_from_object);
/// A turn about an axis of unit length through a place.
Mat34 turned_about(Vec3 place, Vec3 axis, float angle_rad);
/// Scales along orthonormal axes about a place, which stays.
Mat34 scaled_about(Vec3 place, const Mat34& axes, Vec3 factors);

}  // namespace luxel::view
