// Where rays start beside a surface.
#include <algorithm>
#include <cmath>

#include "luxel/trace/ray_tracer.h"

namespace luxel::trace {

float rounding_m(Vec3 position, float scene_diagonal_m) {
  // Interpolating three corners, moving them into the world and intersecting them errs by some ten
  // roundings (2^-24) of the largest number involved; 2^-18 of it is safe and stays under a
  // hundredth of a millimetre per metre. [Waechter19]
  const Vec3 size{std::abs(position.x), std::abs(position.y), std::abs(position.z)};
  return 0x1p-18f * std::max(max_component(size), scene_diagonal_m);
}

Vec3 offset_origin(Vec3 position, Vec3 normal, float scene_diagonal_m) {
  return position + normal * rounding_m(position, scene_diagonal_m);
}

}  // namespace luxel::trace
